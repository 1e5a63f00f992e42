#!/bin/sh
# ik.sh FOLDER [SECONDS | --poses N] [--seed N]: builds the fuzzer of rbd_ik.h in FOLDER, in double and in float, and
# runs one after the other on so many poses of each arm, 10,000, or for so long.
set -eu
folder=${1:?usage: ik.sh FOLDER [SECONDS | --poses N] [--seed N]}
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
    "${CC:-gcc}" -std=gnu99 -O2 -I"$root" -I"$root/tests" -DRBD_REAL=$scalar "$root/tests/fuzz/ik.c" -lm -o "$folder/ik-$scalar"
    echo "$scalar:"
    "$folder/ik-$scalar" "$@"
done
