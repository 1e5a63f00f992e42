# Draws what mpc_hyq_jump wrote:
#     ./mpc_hyq_jump > mpc_hyq_jump.csv
#     gnuplot mpc/hyq_jump.gp
if (!exists("csv")) csv = "mpc_hyq_jump.csv"
if (!exists("png")) png = "mpc/hyq_jump.png"
set terminal pngcairo size 960, 740 font ",10"
set output png
set datafile separator comma
set multiplot

# The robot from the left at several times, side by side; the right legs are gray.
set margins 0, 0, 0, 0
set origin 0.01, 0.77
set size 0.98, 0.23
unset border
unset tics
set xrange [-0.65:9.55]
set yrange [-0.2:0.9]
set size ratio -1
set arrow 1 from -0.65, 0 to 9.55, 0 nohead lc "gray50"
deeds = "', stands' ', crouches' ', leaves' ', highest' ', lands' ', yields' ', stands'"
times = "0 0.24 0.30 0.48 0.66 0.75 1.49"
# Where the figure of a time stands; between two of them in proportion: the way of the trunk joins the figures.
after(i, t) = word(times, i) + 0 <= t && (i == 7 || t < word(times, i + 1) + 0)
part(i, t) = i == 7 ? 0 : (t - word(times, i)) / (word(times, i + 1) - word(times, i))
place(t) = 1.5 * sum [i = 1:7] (after(i, t) ? i - 1 + part(i, t) : 0)
do for [i = 1:7] { set label i word(times, i) . " s" . word(deeds, i) at 1.42 * (i - 1) + 0.08 * (i - 1), -0.13 center }
plot csv index 0 every ::1 using (place($1)):2 with lines lw 2 dt 3 lc "0xc02626" notitle, \
     "" index 1 using 1:($3 == 2 ? $2 : NaN) with lines lw 3 lc "gray60" notitle, \
     "" index 1 using 1:($3 == 0 ? $2 : NaN) with filledcurves closed fc "0x4682b4" notitle, \
     "" index 1 using 1:($3 == 1 ? $2 : NaN) with lines lw 3 lc "black" notitle
unset arrow
unset label
set size noratio
set border
set tics
set grid
set lmargin at screen 0.08
set rmargin at screen 0.98
set xrange [0:1.5]
set yrange [-0.1:1]

# Events by time.
first = 0.56; height = 0.205
set format x ""
set ylabel "m" offset 1
set bmargin at screen first
set tmargin at screen first + height
set key top right
set arrow 2 from 0.4, graph 0.72 to 0.5, graph 0.72 heads size 0.01, 90 lw 2 lc 2
set label 2 "pushed" at 0.41, graph 0.8 tc lt 2
plot csv index 0 every ::1 using 1:3 with lines dt 2 lc "black" title "trunk's height, as planned at first", \
     csv index 0 every ::1 using 1:2 with lines lw 2 lc "black" title "trunk's height", \
     csv index 0 every ::1 using 1:4 with lines lw 2 lc 2 title "trunk to the left"
unset arrow 2
unset label 2

set bmargin at screen first - 0.23
set tmargin at screen first - 0.23 + height
set ylabel "N"
set yrange [*:*]
set key at graph 0.445, 0.95
names = "'left fore foot' 'right fore foot' 'left hind foot' 'right hind foot'"
plot for [c = 5:8] csv index 0 every ::1 using 1:c with lines lw 2 title word(names, c - 4) . ", force up"

set bmargin at screen first - 0.46
set tmargin at screen first - 0.46 + height
set format x "%g"
set xlabel "time, s"
set ylabel "torque / 150 N m"
set yrange [-1.1:1.1]
set key at graph 0.445, 0.95
kinds = "'hips, sideways' 'hips, fore and aft' knees"
plot for [c = 9:20] csv index 0 every ::1 using 1:c with lines lw 1.5 lc (c - 5) / 4 \
     title c % 4 == 1 ? word(kinds, (c - 5) / 4) : ""
