#!/bin/sh
# rbd_spatial.h: compiles without a warning, alone and in every file of a program, with frames checked and not; has no
# symbol; does not take a motion for a force; and frames that nobody checks leave no trace in the code.
# usage: spatial.sh DIRECTORY_OF_RBD_H   with RBD_ALL_TESTS=yes by four compilers, and the implementation behind it with code;
#     else by gcc and clang++-19
set -u

root=${1:?usage: spatial.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
warnings="-pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wvla -Wundef -Werror"
checks=0
failures=0

fail() {
    echo "FAILED: $*"
    sed -n '1,5p' "$scratch/messages"
    failures=$((failures + 1))
}

cat >"$scratch/unchecked.c" <<'END'
#include "rbd_spatial.h"
#include "rbd_spatial.h"
END
cat >"$scratch/checked.c" <<'END'
#ifdef __cplusplus
extern "C"
#endif
void frame_error(const char *file, int line, const char *call, int found, int expected);
#define RBD_CHECK_FRAMES frame_error
#include "rbd_spatial.h"
END
# a call of each kind; FRAME and OTHER are numbers that do not matter
cat >"$scratch/use.c" <<'END'
#include "rbd_spatial.h"
rbd_real use(const rbd_real *a, rbd_real *b);
rbd_real use(const rbd_real *a, rbd_real *b) {
    rbd_placement x = rbd_placement_from_arrays(a, a + 9, FRAME, OTHER);
    rbd_motion v = rbd_motion_up(x, rbd_motion_from_array(a + 12, FRAME));
    rbd_force f = rbd_force_up(x, rbd_force_from_array(a + 18, FRAME));
    rbd_motion_to_array(rbd_motion_cross(v, v), b);
    return rbd_power(v, KIND(v, f));
}
END
{
    cat "$scratch/use.c"
    printf '#define RBD_IMPLEMENTATION\n#include "rbd_spatial.h"\n#include "rbd.h"\nint main(void) { return 0; }\n'
} >"$scratch/main.c" # the implementation after the algebra

# compile FILE COMPILER FLAG...
compile() {
    file=$1
    shift
    checks=$((checks + 1))
    # shellcheck disable=SC2086 # words wanted
    "$@" $warnings -I"$root" -c "$scratch/$file.c" -o "$scratch/$file.o" 2>"$scratch/messages"
}

right='-DFRAME=1 -DOTHER=2 -DKIND(v,f)=f'
compilers="gcc clang++-19" behind=-fsyntax-only
if [ -n "${RBD_ALL_TESTS-}" ]; then
    compilers="gcc g++ clang-19 clang++-19" behind=-O0
else
    echo "SKIPPED but by ./run test --all: g++ and clang-19, and code of the implementation behind it"
fi
for compiler in $compilers; do
    command -v "$compiler" >/dev/null 2>&1 || continue
    standards="c99 c17" language=c
    case $compiler in *++*) standards="c++11 c++20" language=c++ ;; esac
    for standard in $standards; do
        set -- "$compiler" -x "$language" -std="$standard"
        compile unchecked "$@" -O0 || fail "$*"
        compile checked "$@" -O0 || fail "$*, frames checked"
    done
    compile unchecked "$@" -O2 -DRBD_REAL=float || fail "$*, float"
    compile unchecked "$@" -DRBD_LANES=4 -Wno-psabi || fail "$*, lanes"
    # shellcheck disable=SC2086 # words wanted
    compile main "$@" $behind -Dalways_inline=unused $right || fail "$*, the implementation behind it"
    # shellcheck disable=SC2086 # words wanted
    compile use "$@" -O2 $right || fail "$*, use"
    # The absolute symbol (A) is that of RBD_CHECK_SCALAR and takes no room.
    [ "$(nm "$scratch/use.o" | awk '$2 ~ /[B-TV-Z]/ { print $3 }' | wc -l)" -eq 1 ] || fail "$*: more symbols than use"
    mv "$scratch/use.o" "$scratch/one.o"
    compile use "$@" -O2 -DFRAME=5 -DOTHER=6 '-DKIND(v,f)=f' || fail "$*, use"
    cmp -s "$scratch/one.o" "$scratch/use.o" || fail "$*: unchecked frames change the code"
    ! compile use "$@" -DFRAME=1 -DOTHER=2 '-DKIND(v,f)=v' || fail "$*: a motion passes for a force"
done

echo "$checks checks, $failures failed"
[ "$checks" -gt 0 ] && [ "$failures" -eq 0 ]
