#!/bin/sh
# Proves what README.md says by Frama-C's Eva, an abstract interpretation: it covers all inputs that a harness
# admits, or says where it cannot. Prints a line per proof; logs stay in the folder.
# usage: prove.sh FOLDER [quick | all | two]
set -u

here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd) || exit 1
folder=${1:?usage: prove.sh FOLDER [quick | all | two]}
which=${2-all}
command -v frama-c >/dev/null 2>&1 || { echo "skipped: there is no frama-c: ./run deps prove"; exit 77; }
mkdir -p "$folder" || exit 1
failures=0

# rbd.h with an array per object (arrays.h), without pragmas, which Frama-C's parser does not take, and with memory
# taken as it is: the harness aligns it, and Eva does not follow a pointer through an integer.
sed -e 's/^RBDI_PART void \*rbdi_take(/RBDI_PART void *rbdi_take_unused(/' -e 's/_Pragma("[^"]*")//' \
    -e 's/^    return (unsigned char \*)(((uintptr_t)memory + .*/    return (unsigned char *)memory;/' \
    "$here/../../rbd.h" >"$folder/rbd_arrays.h" || exit 1
grep -q '^RBDI_PART void \*rbdi_take_unused(' "$folder/rbd_arrays.h" || { echo "FAILED: rbd.h has no rbdi_take"; exit 1; }
grep -q '^    return (unsigned char \*)memory;' "$folder/rbd_arrays.h" || { echo "FAILED: rbd.h aligns memory in another way"; exit 1; }

# The build's symbol, which may carry the scalar.
build=$(printf '#define RBD_STATIC\n#include "rbd_arrays.h"\nsymbol rbd_model_build\n' |
    cc -E -P -U__GNUC__ -I"$folder" - | sed -n 's/^symbol //p')

# analyse NAME HARNESS DEFINE...: runs Eva; whether it proved all; cases: how many came to the end of the harness
analyse() {
    name=$1 harness=$2
    shift 2
    log=$folder/$(echo "$name" | tr -c 'a-z0-9\n' _).txt
    # All loops are unrolled and the states of a function joined at its end, but for the build's error returns: so
    # indices and sizes stay exact, and all that is computed from numbers becomes an interval.
    frama-c -eva -machdep x86_64 -cpp-extra-args="-I$folder -U__GNUC__ $*" \
        -warn-special-float none -warn-invalid-pointer -warn-signed-overflow -warn-signed-downcast \
        -eva-slevel 0 -eva-min-loop-unroll 160 -eva-auto-loop-unroll 3000 \
        -eva-slevel-function "$build:200" -eva-slevel-function prove_one:200 -eva-slevel-function rbdi_write_finding:50 \
        -eva-split-return-function "$build:0" -eva-alloc-builtin fresh -eva-no-alloc-returns-null \
        -eva-no-show-progress -eva-msg-key=-initial-state,-final-states,-malloc "$here/$harness.c" 2>&1 |
        grep -v 'superposing\|allocating variable\|loop-unroll' >"$log"
    cases=$(grep -c 'Frama_C_show_each_proved' "$log")
    grep -q '^  0 alarms generated' "$log" && grep -q '100% of the logical properties reached have been proven' "$log" &&
        ! grep -q 'status unknown\|status invalid\|User Error\|aborted' "$log"
}

# prove NAME HARNESS COUNT DEFINE...: COUNT is how many cases must come to the end of the harness
prove() {
    name=$1 harness=$2 count=$3
    shift 3
    if analyse "$name" "$harness" "$@" && [ "$cases" -eq "$count" ]; then
        echo "proved: $name, $cases cases, $(sed -n 's/^ *\([0-9]*\) statements.*//; s/^ *In these functions, \([0-9]*\) statements.*/\1 statements/p' "$log")"
    else
        echo "FAILED: $name: $cases cases of $count; see $log"
        grep -A1 'eva:alarm\|User Error' "$log" | head -20
        failures=1
    fi
}

# Each pair of types by itself: together they take more than the sum.
if [ "$which" = two ]; then
    total=0
    for first in 0 1 2 3 4 5 6 7; do
        for second in 0 1 2 3 4 5 6 7; do
            analyse "two bodies $first $second" model -DNB=2 -DFIRST=$first -DSECOND=$second ||
                { echo "FAILED: two bodies, types $first and $second: see $log"; failures=1; }
            total=$((total + cases))
        done
    done
    [ $total -eq 130 ] || { echo "FAILED: two bodies: $total cases of 130"; failures=1; }
    [ $failures -eq 1 ] || echo "proved: two bodies, pairs of types of each shape, $total cases"
    exit $failures
fi
prove 'texts of every length, names' text 162
prove 'one body, any type' model 16 -DNB=1 -DALL_TYPES
[ "$which" = quick ] ||
    prove 'one body, any type, every algorithm' model 16 -DNB=1 -DALGORITHMS -DALL_TYPES
exit $failures
