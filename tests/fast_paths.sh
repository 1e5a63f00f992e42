#!/bin/sh
# Whether the header takes its fast paths: its own sine and cosine, batches as wide as the SIMD unit up to 256 bits, lanes
# exchanged by shuffles, and FMA. For every dialect, processor level and scalar that we claim; by macros, so
# that the preprocessor tells, but for FMA, which is looked for in the code.
# The oldest and the youngest dialect of each kind.
# usage: fast_paths.sh DIRECTORY_OF_RBD_H   with RBD_ALL_TESTS=yes also clang 16, the clang without a version, and each
#     dialect with gcc
set -u

root=${1:?usage: fast_paths.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
c_dialects="c99 c11 c17 gnu99 gnu11 gnu17"
cpp_dialects="c++11 c++20 gnu++11 gnu++20"
few_c="c99 gnu17"
few_cpp="c++11 gnu++20"
[ -n "${RBD_ALL_TESTS-}" ] || { c_dialects=$few_c && cpp_dialects=$few_cpp; }
checks=0
failures=0
missing=

mkdir "$scratch/free" # instead of a C library, which targets may lack, and which takes time to read
echo >"$scratch/free/math.h"
cat >"$scratch/single.c" <<'END'
#define RBD_IMPLEMENTATION
#include "rbd.h"
#ifndef RBDI_POLYNOMIAL_SINCOS
#error "sine and cosine are libm's"
#endif
#if RBDI_BATCH != EXPECTED_BATCH
#error "a batch has not the width of the SIMD unit"
#endif
END
cat >"$scratch/lanes.c" <<'END'
#define RBD_BATCH_IMPLEMENTATION
#include "rbd_batch.h"
#ifndef RBDI_POLYNOMIAL_SINCOS
#error "sine and cosine are libm's"
#endif
#ifndef RBDI_EACH_LANE
#error "lanes are exchanged one by one"
#endif
END

# preprocess FILE COMPILER FLAG...
preprocess() {
    file=$1
    shift
    checks=$((checks + 1))
    "$@" -ffreestanding -I"$scratch/free" -I"$root" -E "$scratch/$file.c" >"$scratch/out" 2>"$scratch/messages" && return
    failures=$((failures + 1))
    echo "FAILED: $*: $file"
    sed -n '1,3p' "$scratch/messages"
}

# dialects DOUBLES DIALECTS COMPILER FLAG...: batches of so many doubles, and twice as many floats; 1: none of either
dialects() {
    doubles=$1 list=$2 floats=$((2 * $1))
    shift 2
    [ "$doubles" -gt 1 ] || floats=1
    for dialect in $list; do
        preprocess single "$@" -std="$dialect" -DRBD_REAL=double -DEXPECTED_BATCH="$doubles"
        preprocess single "$@" -std="$dialect" -DRBD_REAL=float -DEXPECTED_BATCH="$floats"
    done
}

# lanes COMPILER FLAG...
lanes() {
    for number in 2 4 8; do preprocess lanes "$@" -DRBD_LANES="$number"; done
}

# x86 DIALECTS COMPILER FLAG...
x86() {
    those=$1
    shift
    dialects 2 "$those" "$@" -march=x86-64
    dialects 4 "$those" "$@" -march=x86-64-v3
    dialects 4 "$those" "$@" -march=sapphirerapids
    lanes "$@" -march=x86-64
    lanes "$@" -march=sapphirerapids
}

# aarch64 DIALECTS COMPILER FLAG...: without a half precision unit and with one
aarch64() {
    those=$1
    shift
    dialects 2 "$those" "$@" -march=armv8-a
    dialects 2 "$those" "$@" -march=armv8.2-a+fp16
}

# cortex DIALECTS COMPILER FLAG...: with and without floating point, the last with half precision
cortex() {
    those=$1
    shift
    for cpu in "-mcpu=cortex-m0 -mfloat-abi=soft" "-mcpu=cortex-m3 -mfloat-abi=soft" \
        "-mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16" "-mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16" \
        "-mcpu=cortex-m33 -mfloat-abi=hard -mfpu=fpv5-sp-d16" "-mcpu=cortex-m55 -mfloat-abi=hard"; do
        # shellcheck disable=SC2086 # words wanted
        dialects 1 "$those" "$@" $cpu
    done
}

# One call, which is all that a compiler then writes code for.
cat >"$scratch/fma.c" <<'END'
#define RBD_STATIC
#include "single.c"
rbd_status call(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v, rbd_real *tau);
rbd_status call(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v, rbd_real *tau) {
    return rbd_rnea(m, w, q, v, v, NULL, tau);
}
END

# fma DIALECT COMPILER FLAG...: GCC's ISO dialects would leave FMA out.
fma() {
    dialect=$1
    shift
    checks=$((checks + 1))
    "$@" -std="$dialect" -O2 -Dalways_inline=unused -march=x86-64-v3 -DRBD_REAL=double -I"$root" -DEXPECTED_BATCH=4 \
        -w -S "$scratch/fma.c" -o "$scratch/single.s" && [ "$(grep -c vfm "$scratch/single.s")" -gt 100 ] && return
    failures=$((failures + 1))
    echo "FAILED: $*: $dialect: no FMA"
}

# if_there COMPILER COMMAND...: the command, or the compiler's name on the list of what is missing
if_there() {
    tool=$1 before=$checks
    shift
    if ! command -v "$tool" >/dev/null 2>&1; then
        missing="$missing $tool"
        return
    fi
    "$@"
    echo "$tool, $1: $((checks - before)) checks"
}

case $(uname -m) in
x86_64)
    compilers="gcc clang-19"
    if [ -n "${RBD_ALL_TESTS-}" ]; then
        compilers="gcc clang clang-16 clang-19"
    else
        echo "SKIPPED but by ./run test --all: clang-16, clang, and the other dialects with gcc"
    fi
    for compiler in $compilers; do
        case $compiler in
        gcc) c=$c_dialects cpp=$cpp_dialects ;;
        *) c=$few_c cpp=$few_cpp ;;
        esac
        cpp_compiler=$(echo "$compiler" | sed 's/gcc/g++/; s/clang/clang++/')
        if_there "$compiler" x86 "$c" "$compiler"
        if_there "$cpp_compiler" x86 "$cpp" "$cpp_compiler" -x c++
    done
    if_there gcc fma c99 gcc
    if_there gcc fma gnu17 gcc
    if_there g++ fma c++11 g++ -x c++ ;;
*) missing="$missing an x86-64 machine" ;;
esac
if_there aarch64-linux-gnu-gcc aarch64 "$few_c" aarch64-linux-gnu-gcc
if_there clang-19 aarch64 "$few_c" clang-19 --target=aarch64-linux-gnu
if_there arm-none-eabi-gcc cortex "$few_c" arm-none-eabi-gcc
if_there clang-19 cortex "$few_c" clang-19 --target=thumb-none-eabi

echo "$checks checks, $failures failed; missing:${missing:- nothing}"
[ "$checks" -gt 0 ] && [ "$failures" -eq 0 ]
