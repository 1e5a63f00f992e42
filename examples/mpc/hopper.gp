# Draws what mpc_hopper wrote:
#     ./mpc_hopper > mpc_hopper.csv
#     gnuplot mpc/hopper.gp
if (!exists("csv")) csv = "mpc_hopper.csv"
if (!exists("png")) png = "mpc/hopper.png"
set terminal pngcairo size 860, 440 font ",10"
set output png
set datafile separator comma
set multiplot
set grid
set lmargin at screen 0.07

# The leg every 20 ms, and the ways of trunk and foot.
set rmargin at screen 0.45
set bmargin at screen 0.11
set tmargin at screen 0.97
set size ratio -1
set xrange [-0.07:0.57]
set yrange [-0.03:0.75]
set xlabel "m"
set ylabel "m" offset 1
set key top left
set arrow 1 from -0.07, 0 to 0.57, 0 nohead lw 2 lc "gray50"
plot csv every 2::1 using 2:3:($4 - $2):($5 - $3) with vectors nohead lc "gray70" title "leg, every 20 ms", \
     "" every ::1 using 4:5 with lines lw 2 lc "black" title "foot", \
     "" every ::1 using 2:3 with linespoints pt 7 ps 0.6 lw 2 lc "0x4682b4" title "trunk, every 10 ms"
unset arrow
set size noratio

# By time.
set lmargin at screen 0.52
set rmargin at screen 0.98
set xrange [0:1]
set format x ""
unset xlabel
set ylabel "foot's height, mm" offset 1
set bmargin at screen 0.56
set tmargin at screen 0.97
set yrange [0:*]
plot csv every ::1 using 1:(1e3 * $5) with lines lw 2 lc "black" notitle

set bmargin at screen 0.11
set tmargin at screen 0.49
set format x "%g"
set xlabel "time, s"
set ylabel "force on the foot, N"
set yrange [*:*]
set key top right
plot csv every ::1 using 1:7 with steps lw 2 lc "0x4682b4" title "up", \
     "" every ::1 using 1:6 with steps lw 2 lc "0xd2691e" title "along"
