#!/bin/sh
# An example prints what README.md shows for it, and succeeds.
# usage: check.sh README.md NAME PROGRAM [ARGUMENT...]   (shown: the block "```text NAME")
set -eu

readme=$1 name=$2
shift 2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

awk -v start="\`\`\`text $name" '$0 == start { inside = 1; next }
     inside && /^```/ { exit }
     inside { print }' "$readme" >"$scratch/expected"
test -s "$scratch/expected" || { echo "$readme does not show what $name prints"; exit 1; }

status=0
"$@" >"$scratch/printed" 2>&1 || status=$?
sed -i 's/-\(0\.0*\)\([^0-9]\|$\)/ \1\2/g' "$scratch/printed" # the sign of a zero is chance
diff "$scratch/expected" "$scratch/printed"
exit $status
