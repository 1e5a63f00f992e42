#!/bin/sh
# The shipped headers are what src/ makes, and each room compiles alone.
# usage: rooms.sh DIRECTORY_OF_RBD_H
set -u

root=${1:?usage: rooms.sh DIRECTORY_OF_RBD_H}
status=0
python3 "$root/src/amalgamate.py" --check || status=1
cd "$root/src" || exit 1
for room in */*.h; do
    echo "#include \"$room\"" | ${CC:-cc} -std=c99 -Wall -Wextra -Werror -I. -fsyntax-only -x c - ||
        { echo "$room does not compile alone"; status=1; }
done
exit $status
