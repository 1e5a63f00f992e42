#!/bin/sh
# examples/firmware/robot_main.c with the tables that the commands write, on a Cortex-M4F under QEMU, by the lines of
# docs/first_minutes.md: the torques of rbd.h and of the straight-line code are those of rbd-eval on this computer.
# usage: robot_main.sh ROOT TOOLS        about 4 s of a processor; 77 without the compiler or QEMU; with RBD_ALL_TESTS=yes
#                                        a second robot, whose pose stands in the main
#        robot_main.sh ROOT --run NAME   compiles NAME_main.c and NAME_code.c of this folder, and runs them
set -eu
root=$(CDPATH='' cd -- "$1" && pwd)
for program in arm-none-eabi-gcc qemu-system-arm; do
    command -v $program >/dev/null || { echo "skipped: there is no $program: ./run deps firmware"; exit 77; }
done

# The guide's lines, for files of this name.
run() {
    lines=$(sed -n '/^    arm-none-eabi-gcc/,/^$/p' "$root/docs/first_minutes.md" | sed "s/robot_/$1_/g")
    RBD=$root timeout 3600 sh -eu -c "$lines"
}
if [ "$2" = --run ]; then
    run "$3"
    exit
fi

tools=$(CDPATH='' cd -- "$2" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

# The guide's core and memories are those of the firmware examples.
for word in $(grep -e '^cpu =' -e '^memory =' "$root/examples/firmware/cross/cortex-m4f.ini" | grep -o "'[^']*'" | tr -d "'"); do
    grep -q -e " $word " "$root/docs/first_minutes.md" || { echo "the guide lacks $word"; exit 1; }
done

# ROBOT POSE own | given OPTION...: the pose, q by commas, is the main's own, or it stands in the main as the playground
# writes it.
check() {
    urdf=$root/models/$1.urdf pose=$2 whose=$3
    shift 3
    "$tools/rbd-model" "$@" --c-model robot "$urdf" >robot_model.h
    "$tools/rbd-codegen" "$@" --name robot --scalar float "$urdf"
    cp "$root/examples/firmware/robot_main.c" .
    if [ "$whose" = given ]; then
        sed -i -e "/The pose:/,/rbd_integrate/d" -e "s/, half.*;/;/" \
            -e "s/rbd_real q\[ROBOT_NQ\]/const & = {$(echo "$pose" | sed 's/,/f, /g')f}/" robot_main.c
    fi
    run robot >printed
    { sed -n 's/^ *ROBOT_Q_\(\w*\) = .*/q.\1/p' robot_model.h | tr 'A-Z\n' 'a-z,' | sed 's/root_/root./g; s/,$//'
      printf '\n%s\n' "$pose"; } >states.csv
    "$tools/rbd-eval" "$@" --model "$urdf" --algorithm gravity_torque <states.csv >table
    tail -n 1 table | tr , '\n' >expected
    paste -d ' ' expected printed | awk -v robot="$urdf" '
        function off(x, y) { return !((x - y) ^ 2 <= (2e-5 * most) ^ 2) }
        { wanted[NR] = $1; model[NR] = $2; code[NR] = $3; if ($1 ^ 2 > most ^ 2) most = $1 < 0 ? -$1 : $1; bad += NF != 3 }
        END { for (i = 1; i <= NR; i++) if (off(wanted[i], model[i]) || off(wanted[i], code[i])) {
                  print robot ": torque " i " is " wanted[i] ", firmware says " model[i] " and " code[i]; bad++ }
              print robot ": " NR " torques"; exit bad > 0 || NR < 2 || most < 0.1 }'
}
check cart_pole 0.5,0.5 own
[ -n "${RBD_ALL_TESTS-}" ] || { echo "SKIPPED but by ./run test --all: the second robot"; exit; }
check hyq 0.1,-0.2,0.6,0.1,-0.2,0.3,0.9,0.1,-0.1,0.2,-0.2,0.7,0.6,-0.7,-0.6,-1.4,-1.3,1.4,1.5 given --floating
