#!/bin/sh
# constraints.sh FOLDER [SECONDS | --problems N] [OPTION...] [--publish [PROBLEMS]]: builds the fuzzer of
# rbd_constraints.h in FOLDER and runs it for so long, a minute, or on so many problems, against the bounds of
# docs/accuracy_tables.md. With --publish: runs so many problems, 100000, and writes those bounds. Options: those of
# constraints.c.
set -eu
folder=${1:?usage: constraints.sh FOLDER [SECONDS | --problems N] [OPTION...] [--publish [PROBLEMS]]}
shift
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
document=$root/docs/accuracy_tables.md
program=$folder/constraints
mkdir -p "$folder"

flags="-std=c99 -O2 -I$root"
# shellcheck disable=SC2086 # words wanted
{
    "${CC:-gcc}" $flags -c "$root/tests/rbd.c" -o "$folder/rbd.o"
    "${CC:-gcc}" $flags -DBATCH_LANES=2 -c "$root/tests/batch.c" -o "$folder/batch.o"
    "${CC:-gcc}" $flags -DWORLD_LONG_DOUBLE "$root/tests/fuzz/constraints.c" "$root/tests/fuzz/problems.c" \
        "$root/tests/fuzz/robots.c" "$root/tests/fuzz/dense.c" "$root/tests/fuzz/world.c" "$folder/rbd.o" \
        "$folder/batch.o" -lm -o "$program"
}

case ${1-} in
'') exec "$program" --seconds 60 --hold "$document" ;;
--publish) ;;
*[!0-9]*) exec "$program" --hold "$document" "$@" ;;
*) seconds=$1
   shift
   exec "$program" --seconds "$seconds" --hold "$document" "$@" ;;
esac

problems=${2:-100000}
"$program" --problems "$problems" --publish >"$folder/constraints.txt" ||
    { grep -a '^FAIL' "$folder/constraints.txt"; exit 1; }
# The rows between the two marks, and how many problems they are of.
awk -v rows="$folder/constraints.txt" -v problems="$problems" '
    /^<!-- end -->$/ { skip = 0 }
    skip { next }
    /<!-- problems -->/ { sub(/[0-9]+ problems/, problems " problems") }
    { print }
    $0 == "<!-- constraints -->" {
        skip = 1
        getline; print; getline; print
        while ((getline row < rows) > 0) print row
    }' "$document" >"$folder/accuracy.md"
cp "$folder/accuracy.md" "$document"
cat "$document"
