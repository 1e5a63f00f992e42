#!/bin/sh
# windows.sh ROOT: the headers compile without a warning for Windows, by clang as it works beside Visual Studio, and by
# mingw-w64. Skipped (77) if neither is there. By mingw-w64 each header alone with RBD_ALL_TESTS=yes, else all in one file.
set -eu
root=$(realpath "$1")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
strict="-std=c99 -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wvla -Wundef -Werror -fsyntax-only"
mingw=x86_64-w64-mingw32-gcc
checks=0 failed=0

clang=
for name in clang-19 clang-18 clang-17 clang-16 clang; do
    command -v $name >/dev/null && clang=$name && break
done

# The library of Visual Studio is not there: this is all that the headers take from it.
mkdir "$scratch/include"
echo 'double sqrt(double); float sqrtf(float); double sin(double); double cos(double);' >"$scratch/include/math.h"

{
    echo '#define RBD_IMPLEMENTATION'
    sed 's/.*/#include "&"/' "$root/src/headers.txt"
} >"$scratch/all.c"

# check WHAT COMPILER... FILE: without a message
check() {
    what=$1
    shift
    checks=$((checks + 1))
    # shellcheck disable=SC2086 # flags
    "$@" $strict -Dalways_inline=unused -I"$root" 2>"$scratch/err" && return
    failed=$((failed + 1))
    echo "FAILED: $what"
    head -n 20 "$scratch/err"
}

# compiles HEADERS WHAT COMPILER...: each header of the list alone by it, and all in one file with each scalar, and as static
# functions
compiles() {
    headers=$1 what=$2
    shift 2
    for header in $headers; do
        printf '#define RBD_IMPLEMENTATION\n#include "%s"\n' "$header" >"$scratch/file.c"
        check "$header, $what" "$@" "$scratch/file.c"
    done
    for macro in RBD_REAL=float RBD_STATIC; do check "all headers, $macro, $what" "$@" "-D$macro" "$scratch/all.c"; done
}

each=$(cat "$root/src/headers.txt")
if [ -n "$clang" ]; then
    compiles "$each" "clang for Visual Studio" "$clang" --target=x86_64-pc-windows-msvc -I"$scratch/include"
else
    echo "SKIPPED: clang for Visual Studio, which needs clang"
fi
if command -v $mingw >/dev/null; then
    if [ -z "${RBD_ALL_TESTS-}" ]; then
        each=
        echo "SKIPPED but by ./run test --all: each header alone by mingw-w64"
    fi
    compiles "$each" "mingw-w64" $mingw
else
    echo "SKIPPED: mingw-w64 ($mingw)"
fi

[ $checks -gt 0 ] || exit 77
echo "$checks checks, $failed failed"
[ $failed -eq 0 ]
