# Draws what mpc_iiwa wrote:
#     ./mpc_iiwa > mpc_iiwa.csv
#     gnuplot mpc/iiwa.gp
if (!exists("csv")) csv = "mpc_iiwa.csv"
if (!exists("png")) png = "mpc/iiwa.png"
set terminal pngcairo size 720, 640 font ",10"
set output png
set datafile separator comma
set grid
set lmargin 10
set multiplot layout 2, 1
set ylabel "distance from the target, mm"
set logscale y
set yrange [0.05:2000]
plot csv using 1:2 with lines lw 2 lc "black" notitle
unset logscale y
set xlabel "time, s"
set ylabel "torque / limit"
set yrange [-1.1:1.5]
set key top center horizontal
plot for [c = 3:9] csv using 1:c with lines lw 2 title sprintf("joint %d", c - 2)
