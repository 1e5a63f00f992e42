# Draws what replay wrote:
#     ./replay recording.txt replay.csv
#     gnuplot replay.gp
if (!exists("csv")) csv = "replay.csv"
if (!exists("png")) png = "replay.png"
set terminal png size 720, 560 font ",10"
set output png
set datafile separator comma
set grid
set autoscale xfix
set lmargin 9
set rmargin 20
set key outside right top
set multiplot layout 2, 1
set ylabel "wanted less measured, rad"
plot for [j = 1:7] csv using 1:(column(1 + j)) with lines lc j title sprintf("joint %d", j)
set xlabel "time, s"
set ylabel "torque, N m"
plot for [j = 1:7] csv using 1:(column(8 + j)) with lines lc j notitle, \
     for [j = 1:7] csv using 1:(column(15 + j)) every 4::3 with points lc j pt 6 ps 0.6 notitle, \
     NaN with lines lc "black" title "recorded", NaN with points lc "black" pt 6 ps 0.6 title "replayed"
