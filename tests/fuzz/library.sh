#!/bin/sh
# library.sh FOLDER [SECONDS] [--publish [ROBOTS]]: builds the fuzzer of the library in FOLDER, in double and in
# float, and runs both for so long, against the bounds of docs/accuracy_tables.md. With --publish: runs so many robots of
# each class and writes those bounds.
set -eu
folder=${1:?usage: library.sh FOLDER [SECONDS] [--publish [ROBOTS]]}
shift
seconds=60
robots=
while [ $# -gt 0 ]; do
    case $1 in
    --publish) robots=${2:-3000}; shift $# ;;
    *[!0-9]* | '') echo "library.sh: what is $1?" >&2; exit 2 ;;
    *) seconds=$1; shift ;;
    esac
done
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)
document=$root/docs/accuracy_tables.md
mkdir -p "$folder"

for scalar in double float; do
    "${CC:-gcc}" -std=c99 -O2 -I"$root" -DRBD_REAL=$scalar "$root/tests/fuzz/library.c" "$root/tests/fuzz/robots.c" \
        "$root/tests/fuzz/world.c" -lquadmath -lm -o "$folder/library-$scalar"
done

# Both scalars at once. Which of them failed is in what they print.
run() {
    "$folder/library-double" "$@" >"$folder/double.txt" & double=$!
    "$folder/library-float" "$@" >"$folder/float.txt" & float=$!
    status=0
    wait "$double" || status=1
    wait "$float" || status=1
}

if [ -z "$robots" ]; then
    run --seconds "$seconds" --hold "$document"
    cat "$folder/double.txt" "$folder/float.txt"
    exit $status
fi

run --robots "$robots" --publish
for scalar in double float; do
    grep '^FAIL' "$folder/$scalar.txt" && exit 1
    # The rows between the two marks, and how many robots they are of.
    awk -v scalar="$scalar" -v rows="$folder/$scalar.txt" -v robots="$robots" '
        /^<!-- end -->$/ { skip = 0 }
        skip { next }
        /<!-- robots -->/ { sub(/[0-9]+ robots/, robots " robots") }
        { print }
        $0 == "<!-- " scalar " -->" {
            skip = 1
            getline; print; getline; print
            while ((getline row < rows) > 0) print row
        }' "$document" >"$folder/accuracy.md"
    cp "$folder/accuracy.md" "$document"
done
cat "$document"
