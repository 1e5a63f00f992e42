#!/bin/sh
# Files of one program that differ in their scalar (RBD_REAL, RBD_CONST, RBD_LANES) must not link: they would read
# each other's arrays wrongly. Files that agree must. Every function that takes or sizes what depends on the scalar
# carries it in its symbol.
# usage: scalar_link.sh DIRECTORY_OF_RBD_H [COMPILER]
set -eu

root=${1:?usage: scalar_link.sh DIRECTORY_OF_RBD_H [COMPILER]}
compiler=${2-${CC:-cc}}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0

printf '#define RBD_IMPLEMENTATION\n#include "rbd_derivatives.h"\n' >"$scratch/library.c"
printf '#define RBD_BATCH_IMPLEMENTATION\n#include "rbd_derivatives.h"\n' >"$scratch/batch.c"
cp "$scratch/library.c" "$scratch/library.cpp"
# A program as firmware has it: one file sets up, another one controls.
cat >"$scratch/setup.c" <<'END'
#include "rbd.h"
const rbd_model *m;
rbd_work *w;
int setup(void);
int setup(void) {
    static const rbd_body rod[1] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, 1}}};
    static unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 1)];
    return rbd_model_build(rod, 1, model_memory, sizeof model_memory, &m, NULL) ||
           rbd_work_init(m, work_memory, sizeof work_memory, &w);
}
END
cat >"$scratch/control.c" <<'END'
#include "rbd.h"
extern const rbd_model *m;
extern rbd_work *w;
int setup(void);
static rbd_real q[1], tau[1];
static rbd_status (*const call)(const rbd_model *, rbd_work *, const rbd_real *, rbd_real *) = rbd_gravity;
int main(void) { return setup() || call(m, w, q, tau); }
END

# object FILE SCALAR: compiles a file with this scalar, e.g. float or double:4 for four lanes, __float128/double for
# constants of another scalar; without warnings, as compilers have much to say of vectors that are passed in memory;
# in a third of the time without forced inlining
object() {
    lanes='' constant='' real=${2%%[:/]*}
    case $2 in
    *:*) lanes=-DRBD_LANES=${2#*:} ;;
    */*) constant=-DRBD_CONST=${2#*/} ;;
    esac
    # shellcheck disable=SC2086 # words wanted
    $compiler -std=c99 -w -Wno-psabi -Dalways_inline=unused -I"$root" -DRBD_REAL="$real" $lanes $constant \
        -c "$scratch/$1.c" -o "$(object_of "$1" "$2")"
}
object_of() { echo "$scratch/$1-$(echo "$2" | tr / +).o"; }

# expect RESULT SETUP CONTROL LIBRARY: links files of these scalars
expect() {
    # shellcheck disable=SC2086 # words wanted
    if $compiler "$(object_of setup "$2")" "$(object_of control "$3")" "$(object_of library "$4")" \
        -o "$scratch/program" $quadmath -lm >"$scratch/messages" 2>&1; then
        result=links
    elif grep -q 'rbd_work_init\|rbd_gravity' "$scratch/messages"; then # and for no other reason
        result=refused
    else
        result=error
        cat "$scratch/messages"
    fi
    verdict=ok
    [ "$result" = "$1" ] || verdict=FAILED failures=$((failures + 1))
    [ "$result" != links ] || "$scratch/program" || verdict=FAILED failures=$((failures + 1))
    echo "setup $2, control $3, library $4: $result: $verdict"
}

scalars="double float double:2 double:4"
quadmath=
if echo '__float128 x;' | $compiler -x c -c - -o "$scratch/quad.o" 2>/dev/null &&
    echo 'int main(void) { return 0; }' | $compiler -x c - -lquadmath -o "$scratch/quad" 2>/dev/null; then
    scalars="$scalars __float128 __float128/double" quadmath=-lquadmath
else
    echo "left out: __float128, which this compiler has not"
fi
for scalar in $scalars; do
    object setup "$scalar"
    object control "$scalar"
    object library "$scalar"
done
for one in $scalars; do
    for other in $scalars; do
        if [ "$one" = "$other" ]; then
            expect links "$one" "$one" "$one"
        else
            expect refused "$one" "$other" "$one"
        fi
    done
done

# ---- every function, also those of tomorrow ----

# symbols OBJECT: what it defines for others
symbols() { nm "$1" | awk '$2 ~ /[A-TV-Z]/ { print $3 }' | sort; }
# same WHAT EXPECTED FOUND
same() {
    if [ "$2" = "$3" ]; then
        echo "$1: ok"
    else
        echo "$1: FAILED: '$3', not '$2'"
        failures=$((failures + 1))
    fi
}

scalar_free="rbd_finding_text rbd_status_string"
for one in $scalars; do
    symbols "$(object_of library "$one")" >"$scratch/one"
    [ "$(wc -l <"$scratch/one")" -ge 40 ] || failures=$((failures + 1))
    for other in $scalars; do
        [ "$one" != "$other" ] || break # what is left, the other way round
        symbols "$(object_of library "$other")" >"$scratch/other"
        same "common to $one and $other" "$scalar_free" "$(comm -12 "$scratch/one" "$scratch/other" | xargs)"
    done
done
object batch double:2
object batch float:2
symbols "$(object_of batch double:2)" >"$scratch/one"
symbols "$(object_of batch float:2)" >"$scratch/other"
same "functions of a batch" 22 "$(grep -c '^rbd_batch_[a-z_]*_double$' "$scratch/one")"
same "and no others" 22 "$(wc -l <"$scratch/one" | xargs)"
same "common to batches" '' "$(comm -12 "$scratch/one" "$scratch/other" | xargs)"

# C++ has the same names.
if command -v "${CXX:-c++}" >/dev/null 2>&1; then
    "${CXX:-c++}" -std=c++11 -w -Dalways_inline=unused -I"$root" -c "$scratch/library.cpp" -o "$scratch/cpp.o"
    symbols "$(object_of library double)" >"$scratch/one"
    symbols "$scratch/cpp.o" >"$scratch/other"
    same "C and C++" '' "$(diff "$scratch/one" "$scratch/other" | xargs)"
else
    echo "left out: C++, for want of ${CXX:-c++}"
fi
[ "$failures" -eq 0 ]
