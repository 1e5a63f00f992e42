#!/bin/sh
# estimate.sh FOLDER [SECONDS | --problems N] [--seed N]: builds the fuzzer of rbd_estimate.h in FOLDER, in double and in float,
# and runs one after the other for so long, or on so many robots, 20.
set -eu
folder=${1:?usage: estimate.sh FOLDER [SECONDS | --problems N] [--seed N]}
shift
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
mkdir -p "$folder"
case ${1-} in
'' | *[!0-9]*) ;;
*) seconds=$1
   shift
   set -- --seconds "$seconds" "$@" ;;
esac
for scalar in double float; do
    "${CC:-gcc}" -std=gnu99 -O2 -I"$root" -I"$root/tests" -DRBD_REAL=$scalar -DWORLD_LONG_DOUBLE \
        "$root/tests/fuzz/estimate.c" "$root/tests/fuzz/robots.c" "$root/tests/fuzz/world.c" -lm -o "$folder/estimate-$scalar"
    echo "$scalar:"
    "$folder/estimate-$scalar" "$@"
done
