#!/bin/sh
# tables.sh RBD_MODEL: fails if a table in this folder is not what rbd-model writes today.
# tables.sh RBD_MODEL write: writes them.
set -u
rbd_model=$(realpath "${1:?usage: tables.sh RBD_MODEL [write]}") || exit 1
CDPATH='' cd -- "$(dirname -- "$0")" || exit 1 # the tables name the command, with its file
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
status=0

# table FILE OPTION...: the table that rbd-model writes with these options
table() {
    file=$1
    shift
    "$rbd_model" "$@" >"$scratch/$file" || exit 1
    if [ -n "$write" ]; then
        cp "$scratch/$file" "$file"
    elif cmp -s "$scratch/$file" "$file"; then
        echo "$file: up to date"
    else
        echo "$file: out of date; write it again with models/tables.sh RBD_MODEL write"
        status=1
    fi
}

write=${2-}
for robot in iiwa hyq atlas pendulum double_pendulum cart_pole five_bar; do
    case $robot in
    hyq | atlas) set -- --floating ;;
    five_bar) set -- --constraints five_bar_loop.csv ;;
    *) set -- ;;
    esac
    table $robot.h "$@" --c $robot $robot.urdf
    table ${robot}_model.h "$@" --c-model $robot $robot.urdf
done

# The Arduino sketch has its model beside it, as a user's has.
sketch=../examples/arduino_gravity/double_pendulum_model.h
if [ -n "$write" ]; then
    cp double_pendulum_model.h "$sketch"
elif ! cmp -s double_pendulum_model.h "$sketch"; then
    echo "$sketch: not the one of models/; write it again with models/tables.sh RBD_MODEL write"
    status=1
fi
exit $status
