#!/bin/sh
# contacts.sh FOLDER [SECONDS | --problems N] [OPTION...]: builds the fuzzer of rbd_contact.h in FOLDER, in double
# and in float, and runs one after the other for so long, a minute, or on so many problems. Options: those of
# contacts.c.
set -eu
folder=${1:?usage: contacts.sh FOLDER [SECONDS | --problems N] [OPTION...]}
shift
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
mkdir -p "$folder"
flags="-std=c99 -O2 -I$root -DWORLD_LONG_DOUBLE"
for scalar in double float; do
    # shellcheck disable=SC2086 # words wanted
    "${CC:-gcc}" $flags -DRBD_REAL=$scalar "$root/tests/fuzz/contacts.c" "$root/tests/fuzz/robots.c" \
        "$root/tests/fuzz/dense.c" "$root/tests/fuzz/world.c" -lm -o "$folder/contacts-$scalar"
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
    "$folder/contacts-$scalar" "$@"
done
