# Draws what stepping_down wrote:
#     ./stepping_down > stepping_down.csv
#     gnuplot stepping_down.gp
if (!exists("csv")) csv = "stepping_down.csv"
if (!exists("png")) png = "stepping_down.png"
set terminal pngcairo size 720, 640 font ",10"
set output png
set datafile separator comma
set grid
set lmargin 10
set multiplot layout 2, 1
set ylabel "m"
set key top right
plot csv using 1:6 with lines lw 2 title "height of the left fore foot", \
     "" using 1:7 with lines lw 2 title "of the right one", \
     "" using 1:8 with lines lw 2 lc "black" title "trunk to the left"
set xlabel "time, s"
set ylabel "force up, N"
names = "'left fore' 'right fore' 'left hind' 'right hind'"
set yrange [0:520]
set key top center horizontal
plot for [c = 2:5] csv using 1:c with lines lw 2 title word(names, c - 1)
