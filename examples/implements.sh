#!/bin/sh
# An example implements the headers that it includes. The build links examples with a library, which would hide what
# is missing.
# usage: implements.sh DIRECTORY_OF_RBD_H FILE...
set -eu

root=${1:?usage: implements.sh DIRECTORY_OF_RBD_H FILE...}
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0
for file; do
    # shellcheck disable=SC2086 # CC may be "ccache cc"
    ${CC:-cc} -std=c99 -I"$root" -dM -E "$file" | awk '{ print $2 }' >"$scratch/macros"
    grep -qx 'RBD_H\|RBD_QP_H' "$scratch/macros" ||
        { echo "FAILED: $file does not include rbd.h" && failures=$((failures + 1)); }
    for part in '' _DERIVATIVES _CONSTRAINTS _CONTACT _IK _QP _TASKS; do
        ! grep -qx "RBD${part}_H" "$scratch/macros" || grep -qx "RBDI${part}_IMPLEMENTED" "$scratch/macros" ||
            { echo "FAILED: $file does not implement the header of RBD${part}_H" && failures=$((failures + 1)); }
    done
done
echo "$# files, $failures failures"
[ $# -gt 0 ] && [ "$failures" -eq 0 ]
