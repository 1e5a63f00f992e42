#!/bin/sh
# The table of falling_quadruped is whole, and gnuplot makes a picture of it; without gnuplot the test is skipped.
# usage: check_fall.sh PROGRAM falling_quadruped.gp
set -eu

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$1" >"$scratch/fall.csv"

# The energies of each row add up to the same; the centre of mass has fallen by g t^2 / 2 between three rows.
awk -F, 'NR == 1 { if (NF != 9) fail = "columns"; next }
         { height[$1] = $2; sum = $5 + $6 + $7 + $8; if (NR == 2) first = sum }
         (sum - first) ^ 2 > 1 || (sum - $9) ^ 2 > 1e-4 { fail = "energies" }
         END { fallen = height["0.00"] - 2 * height["0.50"] + height["1.00"] + 9.81 * 0.25
               if (fallen ^ 2 > 1e-6) fail = "height"
               if (NR != 102) fail = "rows"
               if (fail) print "wrong " fail
               exit fail != "" }' "$scratch/fall.csv"

command -v gnuplot >/dev/null || { echo "skipped: there is no gnuplot: ./run deps test"; exit 77; }
gnuplot -e "csv = '$scratch/fall.csv'; png = '$scratch/fall.png'" "$2"
[ "$(dd if="$scratch/fall.png" bs=1 skip=1 count=3 2>/dev/null)" = PNG ] || { echo "no picture"; exit 1; }
