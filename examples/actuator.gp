# Draws what actuator wrote:
#     ./actuator curves > actuator.csv
#     gnuplot actuator.gp
if (!exists("csv")) csv = "actuator.csv"
if (!exists("png")) png = "actuator.png"
set terminal pngcairo size 720, 640 noenhanced font ",10"
set output png
set datafile separator comma
set grid
set lmargin 10
set multiplot layout 2, 1
set ylabel "friction, N m"
set key bottom left
set xrange [0:3]
set yrange [0:1.8]
set label "rest" at 0.1, 0.86
set label "load_motor, load_joint" at 0.08, 1.36
set label "coulomb + viscous x" at 1.6, 0.6
plot csv using 1:2 with lines lw 2 title "without load", \
     "" using 1:3 with lines lw 2 title "lifting 4 N m"
unset label
set xrange [0:10]
set yrange [0:30]
set key bottom left
set xlabel "speed of the shaft, rad/s"
set ylabel "torque, N m"
set label "current" at 1, 26.5
set label "voltage" at 7.0, 14
plot csv using 1:4 with lines lw 2 lc "black" title "largest torque"
