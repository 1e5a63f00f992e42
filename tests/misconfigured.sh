#!/bin/sh
# A configuration that cannot work: the compiler says one sentence of ours, first, and nothing else of rbd.h.
# usage: misconfigured.sh DIRECTORY_OF_RBD_H   with RBD_ALL_TESTS=yes by four compilers, else by gcc and clang++-19, each
#     sentence once
set -u

root=${1:?usage: misconfigured.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
checks=0
failures=0
missing=

printf '#define RBD_IMPLEMENTATION\n#include "rbd.h"\n' >"$scratch/file.c"

# says SENTENCE FLAG...: so does each compiler, in its only error; without a sentence there is no message
prefix='rbd: '
says_gcc=
compilers="gcc clang++-19"
if [ -n "${RBD_ALL_TESTS-}" ]; then
    compilers="gcc g++ clang-19 clang++-19"
else
    echo "SKIPPED but by ./run test --all: g++ and clang-19, and a sentence the second time"
fi
said=
says() {
    [ "$1" != "$said" ] || [ -n "${RBD_ALL_TESTS-}" ] || return
    said=$1 sentence=$1
    shift
    for compiler in $compilers; do
        command -v "$compiler" >/dev/null 2>&1 || continue
        case $says_gcc$compiler in yesclang*) continue ;; esac # which has no macro for it
        language="-x c -std=c99"
        case $compiler,$* in
        *++*,*-std*) continue ;;
        *++*) language="-x c++ -std=c++11" ;;
        esac
        checks=$((checks + 1))
        # shellcheck disable=SC2086 # words wanted
        "$compiler" $language "$@" -Wall -Wextra -I"$root" -fsyntax-only "$scratch/file.c" 2>"$scratch/messages"
        errors=$(grep -c 'error:' "$scratch/messages")
        if [ -z "$sentence" ] && [ ! -s "$scratch/messages" ]; then continue; fi
        if [ "$errors" -ne 1 ] || ! grep 'error:' "$scratch/messages" | grep -qF "$prefix$sentence"; then
            failures=$((failures + 1))
            echo "FAILED: $compiler $*: $errors errors"
            sed -n '1,5p' "$scratch/messages"
        fi
    done
}

for lanes in 0 1 3 6 -4 ''; do
    says "RBD_LANES must be 2, 4, 8 or another power of two" "-DRBD_LANES=$lanes"
done
says "RBD_LANES needs GCC or clang, and RBD_REAL double or float" -DRBD_LANES=2 -DRBD_REAL=__float128
for scalar in "long double" int real; do
    says "RBD_REAL must be double, float or __float128" "-DRBD_REAL=$scalar"
done
says "RBD_CONST must be RBD_REAL" -DRBD_CONST=float
says "RBD_CONST must be RBD_REAL" -DRBD_REAL=float -DRBD_CONST=double
says "needs C99 or later" -std=c90
says "needs C99 or later" -std=gnu90

says "RBD_REPRODUCIBLE needs RBD_REAL double or float" -DRBD_REPRODUCIBLE -DRBD_REAL=__float128
case $(gcc -freciprocal-math -dM -E - </dev/null) in
*__RECIPROCAL_MATH__*)
    says_gcc=yes
    says "RBD_REPRODUCIBLE: -freciprocal-math and -fno-signed-zeros change bits" -DRBD_REPRODUCIBLE -freciprocal-math
    says "RBD_REPRODUCIBLE: -freciprocal-math and -fno-signed-zeros change bits" -DRBD_REPRODUCIBLE -fno-signed-zeros
    says_gcc=
    ;;
esac
says "RBD_REPRODUCIBLE needs rbd's own sine" -DRBD_REPRODUCIBLE "-DRBD_SIN=sin" "-DRBD_COS=cos"

for gpu in __CUDACC__ __CUDA__ __HIP__; do
    says "code of a GPU lies in the file that calls it: define RBD_STATIC" "-D$gpu"
done
set -- -D__CUDACC__ -D__host__= -D__device__= -DRBD_STATIC -Wno-attributes -Wno-ignored-attributes
says "" "$@"
says "code of a GPU has one state a thread: leave RBD_LANES undefined" "$@" -DRBD_LANES=4
says "RBD_REPRODUCIBLE has no meaning for code of a GPU" "$@" -DRBD_REPRODUCIBLE

echo '#include "rbd_batch.h"' >"$scratch/file.c"
says "RBD_BATCH_IMPLEMENTATION needs RBD_LANES" -DRBD_BATCH_IMPLEMENTATION
says "the batch calls need RBD_NO_CHOLESKY undefined" -DRBD_LANES=2 -DRBD_BATCH_IMPLEMENTATION -DRBD_NO_CHOLESKY
printf '#include "rbd.h"\n#define RBD_BATCH_IMPLEMENTATION\n#include "rbd_batch.h"\n' >"$scratch/file.c"
says "define RBD_BATCH_IMPLEMENTATION before the first header" -DRBD_LANES=2

# A table before rbd.h, and RBD_FEATURES that do not suffice. Those of two robots, with |, do.
set -- "-I$root/models" -DRBD_STATIC
iiwa='#include "iiwa_model.h"' hyq='#include "hyq_model.h"' rbd='#include "rbd.h"'
with() { printf '%s\n' '#define RBD_IMPLEMENTATION' "$@" >"$scratch/file.c"; }
prefix=
with "$iiwa" "$rbd"
says "include rbd.h before iiwa_model.h" "$@"
with '#define RBD_FEATURES IIWA_FEATURES' "$iiwa" "$rbd" "$iiwa" "$hyq"
says "RBD_FEATURES lacks some of HYQ_FEATURES" "$@"
with '#define RBD_FEATURES 0' "$rbd" "$iiwa"
says "RBD_FEATURES lacks some of IIWA_FEATURES" "$@"
with '#define RBD_FEATURES IIWA_FEATURES | HYQ_FEATURES' "$iiwa" "$hyq" "$rbd" "$iiwa" "$hyq" \
    'extern const rbd_model *const both[2];' \
    'const rbd_model *const both[2] = {&iiwa_model, &hyq_model};'
says '' "$@"

for compiler in gcc clang-19; do command -v "$compiler" >/dev/null 2>&1 || missing="$missing $compiler"; done
echo "$checks checks, $failures failed; missing:${missing:- nothing}"
[ "$checks" -gt 0 ] && [ "$failures" -eq 0 ]
