# Draws what mpc_horizon wrote:
#     ./mpc_horizon > mpc_horizon.csv
#     gnuplot mpc/horizon.gp
if (!exists("csv")) csv = "mpc_horizon.csv"
if (!exists("png")) png = "mpc/horizon.png"
set terminal pngcairo size 860, 560 font ",11"
set output png
set datafile separator comma
set grid
set lmargin 9
set rmargin 2
set xrange [0:6]
set multiplot
set object 1 rectangle from 4, graph 0 to 4.1, graph 1 fc "gray80" fs solid noborder behind

set size 1, 0.66
set origin 0, 0.34
set format x ""
set ylabel "angle of the pole, degrees"
set yrange [-110:290]
set ytics 90
set key at graph 0.02, graph 0.97 left top horizontal samplen 2
set arrow 1 from 0, 180 to 6, 180 nohead lc "gray50" dt 2
set label 1 "upright" at 0.05, 195 tc "gray40"
set label 2 "push" at 4.13, 265 tc "gray40"
degrees(x) = x * 180 / pi
plot csv every ::1 using 1:(degrees($2)) with lines lw 2 dt 4 lc "gray40" title "the plan's forces", \
     "" every ::1 using 1:(degrees($3)) with lines lw 2 lc "0xd2691e" title "with its gains", \
     "" every ::1 using 1:(degrees($5)) with lines lw 2 lc "0x2e8b57" title "anew, 0.4 s ahead", \
     "" every ::1 using 1:(degrees($4)) with lines lw 3 lc "0x4682b4" title "anew, 2 s ahead"
unset arrow 1
unset label

set size 1, 0.36
set origin 0, 0
set format x "%g"
set xlabel "time, s"
set ylabel "motor, N"
set yrange [-12:12]
set ytics 10
plot csv every ::1 using 1:6 with steps lw 1.5 lc "0xd2691e" notitle, \
     "" every ::1 using 1:7 with steps lw 2 lc "0x4682b4" notitle
