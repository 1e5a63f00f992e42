# Draws what whole_body wrote:
#     ./whole_body > whole_body.csv
#     gnuplot whole_body.gp
if (!exists("csv")) csv = "whole_body.csv"
if (!exists("png")) png = "whole_body.png"
set terminal pngcairo size 960, 560 font ",10"
set output png
set datafile separator comma
set grid
set xrange [0:2]
set multiplot

newtons = "100 150 200 300 400"
column_of(controller, k, feet) = 2 + 2 * (5 * controller + k) + feet
color(k) = word("#9ecae1 #4292c6 #08519c #fd8d3c #d94801", k + 1)

# Above what the trunk does, below the foot that slips most; least forces on the left.
set ylabel "trunk to the left, mm"
set yrange [-5:40]
set format x ""
set tmargin at screen 0.92
set bmargin at screen 0.52
set object 1 rectangle from 0.3, graph 0 to 0.4, graph 1 fc "gray85" fs solid noborder behind
do for [c = 0:1] {
    set lmargin at screen (c == 0 ? 0.07 : 0.56)
    set rmargin at screen (c == 0 ? 0.49 : 0.98)
    set title (c == 0 ? "least forces: the feet slip from 150 N on" : "tasks with friction: the trunk gives way and comes back")
    set key top right
    set label 1 (c == 0 ? "it falls: 300 and 400 N" : "") at 0.62, 17
    plot for [k = 0:4] csv using 1:column_of(c, k, 0) with lines lw 2 lc rgb color(k) title word(newtons, k + 1) . " N"
    unset ylabel
    unset label 1
}

unset title
unset key
set ylabel "slip of a foot, mm"
set yrange [-10:150]
set format x "%g"
set xlabel "time, s; pushed in the gray tenth"
set tmargin at screen 0.48
set bmargin at screen 0.09
do for [c = 0:1] {
    set lmargin at screen (c == 0 ? 0.07 : 0.56)
    set rmargin at screen (c == 0 ? 0.49 : 0.98)
    plot for [k = 0:4] csv using 1:column_of(c, k, 1) with lines lw 2 lc rgb color(k) notitle
    unset ylabel
}
