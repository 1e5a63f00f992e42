#!/bin/sh
# Files of one program that differ in their scalar (RBD_REAL, RBD_CONST, RBD_LANES) must not link: they would read
# each other's arrays wrongly. Files that agree must. Every function that takes or sizes what depends on the scalar
# carries it in its symbol.
# usage: scalar_link.sh DIRECTORY_OF_RBD_H [COMPILER]   with RBD_ALL_TESTS=yes also 4 lanes, __float128 with constants in its
#     own precision, and arrays that files share at -O0, with -flto and by clang 16
set -eu

root=${1:?usage: scalar_link.sh DIRECTORY_OF_RBD_H [COMPILER]}
compiler=${2-${CC:-cc}}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0
# What tells the linker the scalar has one name and no section.
compared=rbd_files_differ_in_RBD_REAL_RBD_CONST_RBD_LANES_or_RBD_REPRODUCIBLE

printf '#define RBD_IMPLEMENTATION\n#include "rbd_derivatives.h"\n' >"$scratch/library.c"
printf '#define RBD_BATCH_IMPLEMENTATION\n#include "rbd_derivatives.h"\n#include "rbd_batch.h"\n' >"$scratch/batch.c"
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
static rbd_status (*const call)(const rbd_model *, rbd_work *, const rbd_real *, rbd_real *) = rbd_gravity_torque;
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
    elif grep -q "rbd_work_init\|rbd_gravity_torque\|$compared" "$scratch/messages"; then # and for no other reason
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

scalars="double float double:2"
quads="__float128/double"
if [ -n "${RBD_ALL_TESTS-}" ]; then
    scalars="$scalars double:4" quads="__float128 $quads"
else
    echo "SKIPPED but by ./run test --all: 4 lanes, __float128 with constants in its own precision, shared arrays at -O0, -flto, clang-16"
fi
quadmath=
if echo '__float128 x;' | $compiler -x c -c - -o "$scratch/quad.o" 2>/dev/null &&
    echo 'int main(void) { return 0; }' | $compiler -x c - -lquadmath -o "$scratch/quad" 2>/dev/null; then
    scalars="$scalars $quads" quadmath=-lquadmath
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
symbols() { nm "$1" | awk '$2 ~ /[B-TV-Z]/ { print $3 }' | sort; }
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

# ---- files that use nothing but rbd_real ----

# They have no symbol of rbd.h's functions, but share arrays.
cat >"$scratch/shares.c" <<'END'
#include "rbd.h"
#ifdef __cplusplus
extern "C" {
#endif
extern rbd_real torque[1];
int control(void);
#ifdef __cplusplus
}
#endif
int main(void) { return control() + (torque[0] > 1); }
END
cp "$scratch/shares.c" "$scratch/shares.cpp"
cat >"$scratch/sharing.c" <<'END'
#include "rbd.h"
rbd_real torque[1];
int control(void);
int control(void) { return 0; }
END

# shares RESULT NAME COMPILER_OF_SHARES SCALAR COMPILER_OF_SHARING SCALAR FLAG...: links two files, the latter with flags
shares() {
    expected=$1 name=$2 first=$3 one=$4 second=$5 other=$6
    shift 6
    case $first in *++*) source=shares.cpp ;; *) source=shares.c ;; esac
    # shellcheck disable=SC2086 # words wanted
    $first $flags -w -Dalways_inline=unused -I"$root" -DRBD_REAL="$one" -c "$scratch/$source" -o "$scratch/shares.o" &&
        $second $flags -std=c99 -w -Dalways_inline=unused -I"$root" -DRBD_REAL="$other" "$@" -c "$scratch/sharing.c" \
            -o "$scratch/sharing.o" || failures=$((failures + 1))
    # shellcheck disable=SC2086
    if $first $flags "$scratch/shares.o" "$scratch/sharing.o" -o "$scratch/program" -lm >"$scratch/messages" 2>&1; then
        result=links
    elif grep -q "$compared" "$scratch/messages"; then
        result=refused
    else
        result=error
        cat "$scratch/messages"
    fi
    same "$name, $one and $other$(printf ' %s' '' "$@"): $expected" "$expected" "$result"
}

cases=0
# both NAME COMPILER_OF_SHARES COMPILER_OF_SHARING: unlike scalars are refused, equal ones are not, nor what says 0
both() {
    shares links "$1" "$2" float "$3" float
    shares refused "$1" "$2" double "$3" float
    shares links "$1" "$2" double "$3" float -DRBD_CHECK_SCALAR=0
    shares links "$1" "$2" double "$3" float -DRBD_STATIC
    cases=$((cases + 1))
}

gcc=
! command -v gcc >/dev/null || gcc=gcc
clangs=clang-19 least_cases=1
[ -z "${RBD_ALL_TESTS-}" ] || { clangs="clang-16 clang-19" && least_cases=3; }
for flags in "-O2 -ffunction-sections -fdata-sections -Wl,--gc-sections" -O0 -flto; do
    case ${RBD_ALL_TESTS-}$flags in -O0 | -flto) continue ;; esac
    [ -z "$gcc" ] || both "gcc $flags" gcc gcc
done
flags="-O2 -ffunction-sections -fdata-sections -Wl,--gc-sections"
[ -z "$gcc" ] || ! command -v g++ >/dev/null || both "g++ and gcc $flags" g++ gcc
for clang in $clangs; do
    if command -v $clang >/dev/null; then
        shares links "$clang" "$clang" double "$clang" float # the default
        shares refused "$clang" "$clang -DRBD_CHECK_SCALAR=1" double "$clang" float -DRBD_CHECK_SCALAR=1
        shares links "$clang" "$clang -DRBD_CHECK_SCALAR=1" float "$clang" float -DRBD_CHECK_SCALAR=1
    fi
done
if command -v arm-none-eabi-gcc >/dev/null && [ -e /usr/lib/picolibc/arm-none-eabi ]; then
    flags="-O2 -mcpu=cortex-m4 --specs=picolibc.specs -ffunction-sections -fdata-sections -Wl,--gc-sections"
    both arm-none-eabi-gcc arm-none-eabi-gcc arm-none-eabi-gcc
fi
[ -z "$gcc" ] || [ "$cases" -ge $least_cases ] || failures=$((failures + 1))

# It costs no byte.
if [ -n "$gcc" ]; then
    for check in 0 1; do
        gcc -O1 -w -I"$root" -DRBD_CHECK_SCALAR=$check -c "$scratch/setup.c" -o "$scratch/check$check.o"
    done
    same "bytes without and with the symbol" "$(size -A "$scratch/check0.o" | grep '^\.')" "$(size -A "$scratch/check1.o" | grep '^\.')"
    same "the symbol" "1 0" "$(nm "$scratch/check1.o" | grep -c " A $compared") $(nm "$scratch/check0.o" | grep -c "$compared")"
fi
[ "$failures" -eq 0 ]
