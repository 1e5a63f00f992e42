#!/bin/sh
# A program succeeds, and gnuplot makes a picture of the table that it prints; without gnuplot the test is skipped.
# usage: check_plot.sh PROGRAM FILE.gp
set -eu

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$1" >"$scratch/table.csv"
command -v gnuplot >/dev/null || { echo "skipped: there is no gnuplot: ./run deps test"; exit 77; }
gnuplot -e "csv = '$scratch/table.csv'; png = '$scratch/picture.png'" "$2"
[ "$(dd if="$scratch/picture.png" bs=1 skip=1 count=3 2>/dev/null)" = PNG ] || { echo "no picture"; exit 1; }
