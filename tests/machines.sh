#!/bin/sh
# Runs the reference tests (scalars.c) and the suites of machines.c on another machine, emulated by qemu-user (an
# i386 runs on x86-64 itself, where its kernel lets it), as a program of Windows under wine, as WebAssembly in node, or with a compiler that is neither GCC nor
# clang.
# tests/firmware/check.h stands in for Check. Exits with 77 where compiler or emulator is missing.
# Each machine has one scalar, not optimised but for the x87; with RBD_ALL_TESTS=yes it has all that differ there, optimised,
# and the big-endian one and the x87 the suites. tcc, which takes a moment, has all of it always.
# usage: machines.sh DIRECTORY_OF_RBD_H aarch64 | armhf | i386 | riscv64 | s390x | wasm | wasm-suites | tcc | windows
set -eu

usage='usage: machines.sh DIRECTORY_OF_RBD_H aarch64 | armhf | i386 | riscv64 | s390x | wasm | wasm-suites | tcc | windows'
root=${1:?$usage}
target=${2:?$usage}
all=${RBD_ALL_TESTS-}
dialect=-std=c99
# So it compiles in a quarter of the time. The x87 keeps more digits only where a compiler leaves values in registers.
unforced=-Dalways_inline=unused
optimised="-Og $unforced"
[ -n "$all" ] || [ "$target" = i386 ] || optimised="-O0 $unforced"
link='-static -lm' # no library of the machine's is looked for
emulator=qemu-$target
ending=
case $target in
aarch64 | riscv64) compiler=$target-linux-gnu-gcc ;;
s390x) compiler=s390x-linux-gnu-gcc dialect=-std=gnu99 ;; # in c99 it computes floats as doubles: by libm's sine
armhf) compiler=arm-linux-gnueabihf-gcc emulator=qemu-arm ;;
i386) compiler=i686-linux-gnu-gcc ;;
windows) compiler=x86_64-w64-mingw32-gcc emulator=wine ending=.exe ;;
tcc) compiler=tcc emulator='' link=-lm ;;
wasm*) # a trap ends what outgrows the stack
    compiler='clang-19 --target=wasm32-wasi' emulator="node $root/web/wasm/node.mjs" link='-lm -Wl,-z,stack-size=8388608'
    [ -z "$all" ] || optimised="-O1 $unforced" ;;
*) echo "$usage" >&2; exit 2 ;;
esac
for program in ${compiler%% *} ${emulator%% *}; do
    command -v "$program" >/dev/null 2>&1 || { echo "left out: no $program"; exit 77; }
done
case $target in wasm*) [ -e /usr/lib/wasm32-wasi/libc.a ] || { echo "left out: no wasi-libc"; exit 77; } ;; esac
[ "$target" != tcc ] || [ "$(uname -m)" = x86_64 ] || { echo "left out: tcc elsewhere than on x86-64"; exit 77; }

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# An x86-64 processor runs programs of the i386 itself, if its kernel lets it.
echo 'int main(void) { return 0; }' >"$scratch/nothing.c"
if [ "$target" = i386 ] && $compiler -static "$scratch/nothing.c" -o "$scratch/nothing" && "$scratch/nothing" 2>/dev/null; then
    emulator=
fi

# The fast paths of rbd.h that this machine must take, and those that it must not.
# expect_path PRESENT|ABSENT MACRO OPTION...
expect_path() {
    present=$1 macro=$2
    shift 2
    printf '#define RBD_IMPLEMENTATION\n#include "rbd.h"\n#ifdef %s\nint PRESENT;\n#else\nint ABSENT;\n#endif\n' \
        "$macro" >"$scratch/path.c"
    # shellcheck disable=SC2086 # words wanted
    $compiler $dialect -E "$@" -I"$root" "$scratch/path.c" 2>/dev/null | grep -q "^int $present;" ||
        { echo "FAILED: $macro should be $present with $*"; exit 1; }
}

# object SOURCE OPTION...: compiles tests/SOURCE.c
object() {
    source=$1
    shift
    # shellcheck disable=SC2086 # words wanted
    $compiler $dialect -Wall -Wextra -Werror "$@" -I"$root/tests/firmware" -I"$root" -I"$scratch" \
        -c "$root/tests/$source.c" -o "$scratch/$source.o"
}

# run_linked SOURCE...: links what object has made of them, and runs it
run_linked() {
    objects=
    for source; do objects="$objects $scratch/$source.o"; done
    # shellcheck disable=SC2086 # words wanted
    $compiler $objects $link -o "$scratch/program$ending" && $emulator "$scratch/program$ending"
}

# scalar NAME OPTION...: the reference tests with one scalar
scalar() {
    echo "$target, scalar $1"
    shift
    object scalars "$@"
    run_linked scalars reference control
}

# The suites with double.
suites() {
    echo "$target, suites"
    object rbd -Og $unforced
    set -- support textbook machines
    for suite in $(sed -n 's/^#define SUITES(x)//p' "$root/tests/machines.c" | sed 's/x(\([a-z]*\))/test_\1/g'); do
        set -- "$@" "$suite"
    done
    for source; do object "$source" -O1; done
    run_linked rbd reference control "$@"
}

# shellcheck disable=SC2046 # names without blanks
"$root/tests/data/unpack.py" "$scratch/reference_models.h" $(cd "$root/tests/data" && ls *.bin | sed '/^control/d; s/\.bin$//')
"$root/tests/data/unpack.py" "$scratch/control_models.h" control_iiwa control_tree03 # as on a microcontroller
object reference -O0
object control -O0
if [ "$target" = wasm-suites ]; then
    suites
    exit
fi
# wasm's first is the one with the SIMD unit, below.
[ "$target$all" = wasm ] || scalar double $optimised
[ -n "$all" ] || case $target in
tcc | riscv64) ;;
*) echo "SKIPPED but by ./run test --all: other scalars, optimised code, and the suites" ;;
esac
# tcc 0.9.27 overwrites an argument that is a structure of three floats while it computes the next one; on RISC-V the
# firmware's reference tests are in float.
case $target in tcc | riscv64) ;; *) [ -z "$all" ] || scalar float $optimised -DSCALAR_FLOAT ;; esac
case $target in
aarch64)
    expect_path PRESENT RBDI_POLYNOMIAL_SINCOS
    expect_path ABSENT RBDI_BATCH_SCALAR
    [ -z "$all" ] || scalar '4 lanes' $optimised -DRBD_LANES=4
    ;;
wasm)
    expect_path PRESENT RBDI_POLYNOMIAL_SINCOS
    expect_path PRESENT RBDI_BATCH_SCALAR
    expect_path ABSENT RBDI_BATCH_SCALAR -msimd128
    scalar 'double, SIMD' $optimised -msimd128
    [ -z "$all" ] || scalar 'float, SIMD' $optimised -msimd128 -DSCALAR_FLOAT
    ;;
armhf | riscv64) expect_path PRESENT RBDI_POLYNOMIAL_SINCOS ;;
i386) # the x87 computes with 80 bits: the sine's argument reduction would not be what it is made for
    expect_path ABSENT RBDI_POLYNOMIAL_SINCOS
    expect_path PRESENT RBDI_POLYNOMIAL_SINCOS -msse2 -mfpmath=sse
    [ -z "$all" ] || { scalar 'double, SSE2' $optimised -msse2 -mfpmath=sse && suites; }
    ;;
s390x) # big-endian
    expect_path PRESENT RBDI_POLYNOMIAL_SINCOS
    [ -z "$all" ] || { scalar '4 lanes' -O0 -DRBD_LANES=4 && suites; }
    ;;
tcc | windows)
    expect_path PRESENT RBDI_POLYNOMIAL_SINCOS
    suites
    ;;
esac
