# Draws what replay wrote:
#     ./replay recording.txt replay.csv
#     gnuplot replay.gp
if (!exists("csv")) csv = "replay.csv"
if (!exists("png")) png = "replay.png"
set terminal pngcairo size 960, 720 font ",12"
set output png
set datafile separator comma
set grid
set autoscale xfix
set lmargin 10
set rmargin 3
set key top left Left reverse
set multiplot layout 2, 1

# Joint 4, whose encoder has a loose plug, before the others in gray.
set ylabel "wanted less measured, rad"
plot for [j in "1 2 3 5 6 7"] csv using 1:(column(1 + j)) with lines lw 1.5 lc "gray60" title j eq "1" ? "other joints" : "", \
     csv using 1:5 with lines lw 2 lc "0xd8702a" title "joint 4"

# Joint 2, which passed its limit; each fourth tick as it was computed again.
set xlabel "time, s"
set ylabel "torque, N m"
set yrange [:150]
plot for [j in "1 3 4 5 6 7"] csv using 1:(column(8 + j)) with lines lw 1.5 lc "gray60" title j eq "1" ? "other joints" : "", \
     80 with lines dt 2 lw 1.5 lc "0xc02626" title "limit of joint 2", \
     csv using 1:10 with lines lw 2 lc "0x2f6fde" title "joint 2, recorded", \
     csv using 1:17 every 4::3 with points pt 6 ps 0.9 lw 1.5 lc "black" title "joint 2, computed again"
