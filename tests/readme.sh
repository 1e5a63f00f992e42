#!/bin/sh
# The quick start of README.md compiles as shown and prints what is shown; by every compiler that is there, in the first and the
# last standard of C and C++, with RBD_ALL_TESTS=yes in those between too. README.md is short.
# usage: readme.sh DIRECTORY_OF_RBD_H
set -eu

root=${1:?usage: readme.sh DIRECTORY_OF_RBD_H}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# block LANGUAGE: the first code block of that language, without its fences
block() {
    awk -v start="\`\`\`$1" '$0 == start { inside = 1; next }
         inside && /^```/ { exit }
         inside { print }' "$root/README.md"
}

block c >"$scratch/program.c"
block text >"$scratch/expected"
test -s "$scratch/program.c" || { echo "README.md has no block of C"; exit 1; }
test -s "$scratch/expected" || { echo "README.md does not show what the program prints"; exit 1; }

lines=$(wc -l <"$scratch/program.c")
[ "$lines" -le 13 ] || { echo "the program has $lines lines, more than 13"; exit 1; }
[ "$(wc -l <"$root/README.md")" -le 250 ] || { echo "README.md has more than 250 lines"; exit 1; }

# In a third of the time without forced inlining.
# shellcheck disable=SC2086 # CC may be "ccache cc"
${CC:-cc} -std=c99 -Dalways_inline=unused -Wall -Wextra -pedantic -Werror -I"$root" "$scratch/program.c" -o "$scratch/program" -lm
"$scratch/program" >"$scratch/printed"
diff "$scratch/expected" "$scratch/printed"

cp "$scratch/program.c" "$scratch/program.cpp"
compiled=0
# each COMPILER ENDING STANDARD...: compiles the program in each standard
each() {
    compiler=$1 ending=$2
    shift 2
    command -v "$compiler" >"$scratch/path" || return 0
    code=-O0 # the first standard makes code too; the others decide on syntax and meaning alone
    for standard; do
        case ${RBD_ALL_TESTS-}$standard in c11 | c++14 | c++17) continue ;; esac
        # shellcheck disable=SC2086 # words wanted
        "$compiler" "-std=$standard" $code -Dalways_inline=unused -I"$root" -c "$scratch/program.$ending" -o "$scratch/program.o" ||
            { echo "$compiler -std=$standard does not compile the program"; exit 1; }
        compiled=$((compiled + 1))
        [ "$compiler" = tcc ] || code="-O0 -fsyntax-only"
    done
}
[ -n "${RBD_ALL_TESTS-}" ] || echo "SKIPPED but by ./run test --all: the standards between the first and the last"
each gcc c c99 c11 c17
each clang-19 c c99 c11 c17
each tcc c c99 c11
each g++ cpp c++11 c++14 c++17 c++20
each clang++-19 cpp c++11 c++14 c++17 c++20
echo "compiled $compiled times"
