# Draws what felt_push wrote:
#     ./felt_push > felt_push.csv
#     gnuplot felt_push.gp
if (!exists("csv")) csv = "felt_push.csv"
if (!exists("png")) png = "felt_push.png"
set terminal pngcairo size 720, 560 noenhanced font ",10"
set output png
set datafile separator comma
set grid
set lmargin 10
set multiplot layout 2, 1
set ylabel "joint 2, N m"
set key top right horizontal
plot csv using 1:(-$3):3 with filledcurves lc rgb "#dddddd" title "band: may be friction", \
     "" using 1:4 with lines lw 1 lc "black" title "torque of the push", \
     "" using 1:2 with lines lw 2 lc rgb "#c00000" title "felt"
set ylabel "joint 4, N m"
set xlabel "time, s: the arm moves, from 3 s on it rests"
unset key
plot csv using 1:(-$6):6 with filledcurves lc rgb "#dddddd" notitle, \
     "" using 1:7 with lines lw 1 lc "black" notitle, \
     "" using 1:5 with lines lw 2 lc rgb "#c00000" notitle
