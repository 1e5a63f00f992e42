# Draws what mpc_atlas_somersault wrote:
#     ./mpc_atlas_somersault > mpc_atlas_somersault.csv
#     gnuplot mpc/atlas_somersault.gp
if (!exists("csv")) csv = "mpc_atlas_somersault.csv"
if (!exists("png")) png = "mpc/atlas_somersault.png"
set terminal pngcairo size 960, 760 font ",11"
set output png
set datafile separator comma
set multiplot

# The robot from the left every tenth of a second, side by side; its right limbs are gray.
set margins 0, 0, 0, 0
set origin 0.01, 0.68
set size 0.98, 0.31
unset border
unset tics
set xrange [-0.9:13.7]
set yrange [-1.4:2.4]
set size ratio -1
do for [i = 0:8] { set label i + 1 sprintf("%.1f s", 0.1 * i) at 1.6 * i, -1.25 center }
plot csv index 1 using 1:($3 == 0 ? $2 : NaN) with lines lw 3 lc "gray60" notitle, \
     "" index 1 using 1:($3 == 1 ? $2 : NaN) with lines lw 3 lc "black" notitle, \
     "" index 1 using 1:($3 == 2 ? $2 : NaN) with points pt 7 ps 2.2 lc "0x4682b4" notitle
unset label
set size noratio
set border
set tics
set grid
set lmargin at screen 0.09
set rmargin at screen 0.98
set xrange [0:0.8]

# Events by time.
first = 0.42; height = 0.24
set bmargin at screen first
set tmargin at screen first + height
set format x ""
set yrange [0:400]
set ytics 90
set ylabel "degrees forward"
set key top left
plot csv index 0 every ::1 using 1:4 with lines lw 2 dt 2 lc "gray40" title "if the joints were locked", \
     "" index 0 every ::1 using 1:2 with lines lw 2 lc "black" title "the pelvis"

set bmargin at screen first - 0.17
set tmargin at screen first - 0.17 + 0.15
set yrange [0:1.1]
set ytics 0.5
set ylabel "torque / limit"
plot csv index 0 every ::1::40 using 1:6 with steps lw 2 title "largest torque"

set bmargin at screen first - 0.34
set tmargin at screen first - 0.34 + 0.15
set format x "%g"
set xlabel "time, s"
set logscale y
set format y "10^{%T}"
set yrange [1e-16:1e-8]
set ytics 100
set ylabel "relative"
set key bottom right
plot csv index 0 every ::1 using 1:5 with lines lw 2 title "change of the angular momentum"
