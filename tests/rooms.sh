#!/bin/sh
# The shipped headers are what src/ makes; includes and storeys are in order (tests/adequacy/rooms.py); each room
# compiles alone.
# usage: rooms.sh DIRECTORY_OF_RBD_H
set -u

root=${1:?usage: rooms.sh DIRECTORY_OF_RBD_H}
messages=$(mktemp) || exit 1
trap 'rm -f "$messages"' EXIT
status=0
python3 "$root/src/amalgamate.py" --check || status=1
python3 "$root/tests/adequacy/rooms.py" || status=1
cd "$root/src" || exit 1
for room in */*.h; do
    head -n 1 "$room" | grep -q '^#ifndef RBDI_' || continue # text that rooms include
    lanes=
    case $room in batch/*) lanes="-DRBD_LANES=2 -Wno-unused-function" ;; esac
    # shellcheck disable=SC2086 # words wanted
    echo "#include \"$room\"" | ${CC:-cc} -std=c99 -Wall -Wextra -Werror $lanes -I. -fsyntax-only -x c - 2>"$messages" ||
        { echo "$room does not compile alone"; sed -n 1,4p "$messages"; status=1; }
done
exit $status
