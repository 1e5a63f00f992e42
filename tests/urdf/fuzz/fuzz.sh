#!/bin/sh
# fuzz.sh FOLDER [SECONDS]: builds the fuzz target in FOLDER and runs it, starting from the project's URDF
# files. Fails if it finds a crash; the input lies in FOLDER then.
set -eu
folder=${1:?usage: fuzz.sh FOLDER [SECONDS]}
seconds=${2:-60}
root=$(CDPATH='' cd -- "$(dirname -- "$0")/../../.." && pwd)
mkdir -p "$folder/corpus" "$folder/seeds"

# A seed is a byte of options and a file; the corpus has that byte already.
cp "$root"/tests/urdf/fuzz/corpus/* "$folder/seeds"
for file in "$root"/models/*.urdf "$root"/tests/urdf/nasty.urdf "$root"/tests/urdf/*/*.urdf; do
    for options in 0 1 2 5 ,; do # with the comma joints may move no mass, and wrong mimics move freely
        { printf '%s' "$options"; cat "$file"; } >"$folder/seeds/$options.$(basename "$file")"
    done
done

# shellcheck disable=SC2046 # flags wanted
clang++-19 -std=c++17 -g -O1 -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all \
    -I"$root" "$root/tests/urdf/fuzz/urdf_fuzz.cpp" -o "$folder/urdf_fuzz" \
    $(pkg-config --cflags --libs urdfdom)
cd "$folder"
exec ./urdf_fuzz -max_total_time="$seconds" -max_len=20000 -timeout=20 -print_final_stats=1 \
    -dict="$root/tests/urdf/fuzz/urdf.dict" corpus seeds
