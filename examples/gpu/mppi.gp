# Draws what mppi wrote:
#     ./mppi > mppi.csv
#     gnuplot gpu/mppi.gp
if (!exists("csv")) csv = "mppi.csv"
if (!exists("png")) png = "gpu/mppi.png"
set terminal pngcairo size 860, 400 font ",10"
set output png
set datafile separator comma
set multiplot
set grid

# The hand from above, every 10 ms.
set lmargin at screen 0.07
set rmargin at screen 0.42
set bmargin at screen 0.13
set tmargin at screen 0.96
set size ratio -1
set xrange [0.05:0.95]
set yrange [-0.55:0.5]
set xlabel "x, m"
set ylabel "y, m" offset 1
set key bottom right
set object 1 circle at 0.5, 0 size 0.12 fillcolor "gray80" fillstyle solid noborder
set label 1 "pillar" at 0.5, 0 center
plot csv every ::1 using 5:6 with linespoints pt 7 ps 0.4 lw 2 lc "0x4682b4" title "hand, every 10 ms", \
     "+" using (0.5):(0.4) every ::0::0 with points pt 2 ps 1.5 lw 2 lc "black" title "target"
unset object 1
unset label 1
set size noratio

# Pole and force by time.
set lmargin at screen 0.52
set rmargin at screen 0.98
set xrange [0:4]
set format x ""
unset xlabel
set ylabel "pole's angle / π" offset 1
set bmargin at screen 0.58
set tmargin at screen 0.96
set yrange [-1:1.2]
plot csv every ::1 using (0.02 * $1):($3 / pi) with lines lw 2 lc "black" notitle

set bmargin at screen 0.13
set tmargin at screen 0.51
set format x "%g"
set xlabel "time, s"
set ylabel "force, N" offset 1
set yrange [-11:11]
plot csv every ::1 using (0.02 * $1):4 with steps lw 2 lc "0xd2691e" notitle
