# Draws what energy wrote:
#     ./energy > energy.csv
#     gnuplot contact/energy.gp
# With MuJoCo's curves, if `mujoco` names the file that bench/contact/energy_mujoco.c wrote.
if (!exists("csv")) csv = "energy.csv"
if (!exists("png")) png = "contact/energy.png"
curves = exists("mujoco") ? 3 : 0
if (curves == 0) mujoco = csv
names = "'MuJoCo, Euler' 'MuJoCo, implicit' 'MuJoCo, RK4'"
set terminal pngcairo size 760, 720 font ",10"
set output png
set datafile separator comma
set grid
set lmargin 11
set multiplot layout 2, 1
set logscale y
set format y "10^{%T}"
size(x) = abs(x) > 1e-9 ? abs(x) : NaN
set key outside right
set ylabel "change of energy, share of 900 J"
set yrange [1e-9:10]
set title "a box tumbles at 30 rad/s, by steps of 5 ms"
plot csv index 0 using 1:(size($2)) with lines lw 2 lc 7 title "first order", \
     "" index 0 using 1:(size($4)) with lines lw 3 lc "black" title "second order", \
     "" index 0 using 1:(size($3)) with lines lw 2 lc 6 title "Runge-Kutta 4", \
     for [c = 1:curves] mujoco index 0 using 1:(size(column(c + 1))) with lines dt c + 1 lc 2 * c title word(names, c)
set xlabel "time, s"
set ylabel "change of energy, J"
set yrange [1e-7:10]
set title "an arm swings on a trunk whose feet stick, by steps of 1 ms"
plot csv index 1 using 1:(size($2)) with lines lw 2 lc 7 title "first order", \
     "" index 1 using 1:(size($3)) with lines lw 3 lc "black" title "second order", \
     for [c = 1:curves] mujoco index 1 using 1:(size(column(c + 1))) with lines dt c + 1 lc 2 * c title word(names, c)
