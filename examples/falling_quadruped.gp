# Draws what falling_quadruped wrote:
#     ./falling_quadruped > falling_quadruped.csv
#     gnuplot falling_quadruped.gp
if (!exists("csv")) csv = "falling_quadruped.csv"
if (!exists("png")) png = "falling_quadruped.png"
set terminal pngcairo size 720, 640 font ",10"
set output png
set datafile separator comma
set grid
set lmargin 10
set multiplot layout 2, 1
set ylabel "height, m"
set key bottom left
plot csv using 1:2 with lines lw 2 lc "black" title "centre of mass", \
     "" using 1:3 with lines lw 2 title "left fore knee", \
     "" using 1:4 with lines lw 2 title "right hind knee"
set xlabel "time, s"
set ylabel "energy, change since the start, J"
set key top left
names = "kinetic potential elastic dissipated sum"
array start[9]
do for [c = 5:9] { stats csv every ::1::1 using c nooutput; start[c] = STATS_min }
plot for [c = 5:8] csv using 1:(column(c) - start[c]) with lines lw 2 title word(names, c - 4), \
     "" using 1:(column(9) - start[9]) with lines lw 2 dt 2 lc "black" title "sum"
