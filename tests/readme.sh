#!/bin/sh
# The quick start of README.md compiles as shown and prints what is shown.
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
[ "$lines" -le 25 ] || { echo "the program has $lines lines, more than 25"; exit 1; }

# In a third of the time without forced inlining.
# shellcheck disable=SC2086 # CC may be "ccache cc"
${CC:-cc} -std=c99 -Dalways_inline=unused -Wall -Wextra -pedantic -Werror -I"$root" "$scratch/program.c" -o "$scratch/program" -lm
"$scratch/program" >"$scratch/printed"
diff "$scratch/expected" "$scratch/printed"
