#!/bin/sh
# contacts.sh FOLDER [SECONDS | --problems N] [OPTION...] [--publish [PROBLEMS]]: builds the fuzzer of rbd_contact.h in
# FOLDER, in double and in float, and runs one after the other for so long, a minute, or on so many problems. With
# --publish: runs so many, a million, and writes the tables of docs/accuracy_tables.md and their files in bench/results.
# Options: those of contacts.c.
set -eu
folder=${1:?usage: contacts.sh FOLDER [SECONDS | --problems N] [OPTION...] [--publish [PROBLEMS]]}
shift
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
mkdir -p "$folder"
flags="-std=c99 -O2 -I$root -DWORLD_LONG_DOUBLE"
for scalar in double float; do
    # shellcheck disable=SC2086 # words wanted
    "${CC:-gcc}" $flags -DRBD_REAL=$scalar "$root/tests/fuzz/contacts.c" "$root/tests/fuzz/robots.c" \
        "$root/tests/fuzz/dense.c" "$root/tests/fuzz/world.c" -lm -o "$folder/contacts-$scalar"
done
publish=
case ${1-} in
'') set -- --seconds 60 ;;
--publish) publish=yes
           set -- --problems "${2:-1000000}" --publish "$root/bench/results" ;;
*[!0-9]*) ;;
*) seconds=$1
   shift
   set -- --seconds "$seconds" "$@" ;;
esac
for scalar in double float; do
    echo "$scalar:"
    "$folder/contacts-$scalar" "$@"
done
[ -z "$publish" ] || python3 "$root/tests/figures.py" --write
