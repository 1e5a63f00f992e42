# Draws what contact_walking_quadruped wrote:
#     ./walking_quadruped > walking_quadruped.csv
#     gnuplot contact/walking_quadruped.gp
if (!exists("csv")) csv = "walking_quadruped.csv"
if (!exists("png")) png = "contact/walking_quadruped.png"
set terminal pngcairo size 960, 700 font ",10"
set output png
set datafile separator comma
set multiplot

# The robot from its right at several times, side by side; the legs of the other side are gray.
set margins 0, 0, 0, 0
set origin 0.01, 0.76
set size 0.98, 0.24
unset border
unset tics
set xrange [-0.75:9.75]
set yrange [-0.25:1.1]
set size ratio -1
times = "0 5.0 9.4 14.0 18.0 24.5 26.1"
do for [i = 1:7] { set label i word(times, i) . " s" at 1.5 * (i - 1), -0.17 center }
plot csv index 1 using 1:($3 == 3 ? $2 : NaN) with lines lw 2 lc "gray40" notitle, \
     csv index 1 using 1:($3 == 1 ? $2 : NaN) with lines lw 3 lc "gray60" notitle, \
     "" index 1 using 1:($3 == 0 ? $2 : NaN) with filledcurves closed fc "0x4682b4" notitle, \
     "" index 1 using 1:($3 == 2 ? $2 : NaN) with lines lw 3 lc "black" notitle
unset label
set size noratio
set border
set tics
set grid
set lmargin at screen 0.08
set rmargin at screen 0.98
set xrange [0:27.5]

# Events by time.
set format x ""
set ylabel "m"
set yrange [*:*]
set bmargin at screen 0.53
set tmargin at screen 0.75
set key top left
set arrow 2 from 26, graph 0.85 to 26.1, graph 0.85 heads size 0.1, 90 lw 2 lc 2
set label 2 "pushed" at 25.8, graph 0.85 right tc lt 2
plot csv index 0 every ::1 using 1:2 with lines lw 2 lc 4 title "trunk forward", \
     "" index 0 every ::1 using 1:4 with lines lw 2 lc "black" title "trunk's height", \
     "" index 0 every ::1 using 1:3 with lines lw 2 lc 2 title "trunk to the left"
unset arrow 2
unset label 2
set format x "%g"
set xlabel "time, s"
set ylabel "force up, each foot's over its line"
set yrange [0:4]
set ytics ("right hind" 0, "left hind" 1, "right fore" 2, "left fore" 3)
set bmargin at screen 0.08
set tmargin at screen 0.5
unset key
set label 1 "1000 N" at graph 0.995, first 3.9 right
scale(f) = f < 1000 ? f / 1000 : 1
plot for [c = 5:8] csv index 0 every ::1 using 1:(8 - c + scale(column(c))) with lines lw 1.5 lc c - 4
