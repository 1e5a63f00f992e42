#!/bin/sh
# The headers compile without a warning as clang compiles for Visual C++: neither GNU C nor libm's headers are there, only what
# a compiler itself has. As C and C++; all headers, and the declarations alone.
# usage: msvc.sh DIRECTORY_OF_RBD_H
set -eu

root=${1:?usage: msvc.sh DIRECTORY_OF_RBD_H}
command -v clang-19 >/dev/null 2>&1 || { echo "needs clang-19"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# All that rbd takes of the C library.
cat >"$scratch/math.h" <<'END'
#ifdef __cplusplus
extern "C" {
#endif
double sin(double), cos(double), sqrt(double);
float sinf(float), cosf(float), sqrtf(float);
#ifdef __cplusplus
}
#endif
END

grep -v batch "$root/src/headers.txt" | sed 's/.*/#include "&"/' >"$scratch/declarations.c"
{ echo '#define RBD_IMPLEMENTATION'; cat "$scratch/declarations.c"; } >"$scratch/implementation.c"
for unit in declarations implementation; do
    for language in '-x c -std=c99 -pedantic' '-x c -std=c17 -pedantic' '-x c++ -std=c++11' '-x c++ -std=c++20'; do
        for real in double float; do
            # shellcheck disable=SC2086 # words wanted
            clang-19 --target=x86_64-pc-windows-msvc $language -ffreestanding -isystem "$scratch" -Wall -Wextra -Wshadow -Werror \
                -DRBD_REAL=$real -I"$root" -fsyntax-only "$scratch/$unit.c" || { echo "FAILED: $unit, $language, $real"; exit 1; }
        done
    done
done
echo "16 combinations, 0 failed"
