# Draws what energy wrote:
#     ./energy > energy.csv
#     gnuplot contact/energy.gp
# With MuJoCo's curves, if bench/contact/energy_mujoco.c wrote them to a file that `mujoco` names.
if (!exists("csv")) csv = "energy.csv"
if (!exists("png")) png = "contact/energy.png"
set terminal pngcairo size 760, 680 font ",10"
set output png
set datafile separator comma
set grid
set lmargin 11
set multiplot layout 2, 1
set key top right
set ylabel "change of energy, share of 900 J"
set yrange [-0.6:1]
set title "a box tumbles at 30 rad/s, steps of 5 ms"
plot csv index 0 using 1:2 with lines lw 2 lc 1 title "first order", \
     "" index 0 using 1:3 with lines lw 2 dt 2 lc 3 title "Runge-Kutta 4", \
     "" index 0 using 1:4 with lines lw 3 lc "black" title "second order: rbd\\\_contact\\\_step", \
     for [c = 2 : exists("mujoco") ? 4 : 1] exists("mujoco") ? mujoco : csv index 0 using 1:c with lines lw 1 title columnhead(c)
set xlabel "time, s"
set ylabel "change of energy, J"
set autoscale y
set title "an arm swings on a trunk whose feet stick, steps of 1 ms"
plot csv index 1 using 1:2 with lines lw 2 lc 1 title "first order", \
     "" index 1 using 1:3 with lines lw 3 lc "black" title "second order", \
     for [c = 2 : exists("mujoco") ? 4 : 1] exists("mujoco") ? mujoco : csv index 1 using 1:c with lines lw 1 title columnhead(c)
