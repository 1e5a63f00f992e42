#!/bin/sh
# qp.sh FOLDER [SECONDS | --problems N] [--seed N]: builds the fuzzer of rbd_qp.h in FOLDER, in double and in float, and
# runs one after the other for so long, a minute, or on so many problems of each kind.
set -eu
folder=${1:?usage: qp.sh FOLDER [SECONDS | --problems N] [--seed N]}
shift
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
mkdir -p "$folder"
for scalar in double float; do
    "${CC:-gcc}" -std=gnu99 -O2 -I"$root" -DRBD_REAL=$scalar "$root/tests/fuzz/qp.c" -lm -o "$folder/qp-$scalar"
done
case ${1-} in
'') set -- --seconds 60 ;;
*[!0-9]*) ;;
*) seconds=$1
   shift
   set -- --seconds "$seconds" "$@" ;;
esac
for scalar in double float; do
    echo "$scalar:"
    "$folder/qp-$scalar" "$@"
done
