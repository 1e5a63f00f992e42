#!/bin/sh
# rbd-model, rbd-eval and rbd-codegen on MJCF files: outputs, messages, exit statuses.
# usage: commands.sh ROOT RBD_MODEL RBD_EVAL RBD_CODEGEN yes|no   whether they are built with MuJoCo
set -u
root=$(realpath "$1") rbd_model=$(realpath "$2") rbd_eval=$(realpath "$3") rbd_codegen=$(realpath "$4") with=$5
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
files=$root/tests/mjcf
failed=0

fail() { echo "FAILED: $*"; failed=1; }

# expect STATUS MESSAGE COMMAND...: the exit status, and a text that standard error has ("" = nothing at all)
expect() {
    status=$1 message=$2
    shift 2
    "$@" >out 2>err
    found=$?
    [ $found -eq "$status" ] || { fail "exit status $found, not $status: $*"; cat err; }
    if [ -n "$message" ]; then
        grep -qF -- "$message" err || { fail "no '$message': $*"; cat err; }
    elif [ -s err ]; then
        fail "something on standard error: $*"
        cat err
    fi
}

# has TEXT: a line of the output
has() { grep -qF -- "$1" out || { fail "no '$1' in:"; cat out; }; }

if [ "$with" = no ]; then
    expect 1 "Debian: libmujoco-dev" "$rbd_model" "$files/joints.xml"
    exit $failed
fi

# The content decides, whatever the name; comments and a declaration may come before.
expect 0 "" "$rbd_model" "$files/joints.xml"
has "joints: 24 links, 17 bodies, 26 degrees of freedom (q has 30 numbers)"
has "saddle           spherical"
cp "$files/geoms.xml" robot.urdf
expect 0 "" "$rbd_model" robot.urdf
{ printf '\357\273\277<?xml version="1.0"?>\n<!-- <robot> -->\n<!DOCTYPE x>\n'; tail -n +2 "$files/geoms.xml"; } >odd
expect 0 "" "$rbd_model" odd
expect 0 "" "$rbd_model" - <"$files/geoms.xml"
printf '<robot name="r"><!-- <mujoco> --><mujoco/><link name="a"/></robot>' >urdf.xml
expect 1 "nothing moves" "$rbd_model" urdf.xml
printf '<mujoco>\n<worldbody>\n<boody/></worldbody></mujoco>' >broken.xml
expect 1 "is the file for a newer MuJoCo?" "$rbd_model" broken.xml

# Options.
expect 1 "--floating: an MJCF file says itself whether its root is free, by <freejoint/>" \
    "$rbd_model" --floating "$files/geoms.xml"
expect 1 "--root: only of URDF files" "$rbd_model" --root box "$files/geoms.xml"
expect 0 "" "$rbd_model" --keep on_plate "$files/joints.xml"
has "on_plate_fixed   fixed, kept"
expect 0 "" "$rbd_model" --lock limb=0.3 "$files/geoms.xml"
has "geoms: 4 links, 3 bodies, 9 degrees"
expect 1 "equality 'curved'" "$rbd_model" --strict "$files/equalities.xml"
expect 0 "warning: tendons are left out: 'rope', 'couple'" "$rbd_model" --check "$files/left_out.xml"

# Outputs: what they cannot say is said.
expect 1 "joint 'joint_6' is a ball, which URDF has not" "$rbd_model" --urdf "$files/joints.xml"
expect 0 "warning: gravity 9.81,0,0 of the file is not in this output" "$rbd_model" --c geoms "$files/geoms.xml"
"$rbd_model" --urdf "$files/equalities.xml" >equalities.urdf 2>err
expect 0 "" "$rbd_model" equalities.urdf
has "prismatic = -0.15 left_a + 0.1"
expect 0 "equality 'curved'" "$rbd_model" --c equalities "$files/equalities.xml"
has '{"turned", 3, 8,'
has "EQUALITIES_CONSTRAINTS = 4, EQUALITIES_ROWS = 18"
{ echo '#define RBD_IMPLEMENTATION'; echo '#include "rbd.h"'; cat out; echo 'int main(void) { return equalities_constraints[0].axes[5] != 1; }'; } >table.c
${CC:-cc} -std=c99 -O0 -Dalways_inline=unused -I"$root" table.c -lm -o table && ./table || fail "the table does not compile"
expect 0 "" "$rbd_model" --c-model geoms "$files/geoms.xml"

# The constraints of the file, by its own name.
cat >loop.xml <<END
<mujoco model="loop"><worldbody>
<body name="a"><joint axis="0 1 0"/><geom size="0.1" pos="0 0 1"/></body>
<body name="b" pos="1 0 0"><joint axis="0 1 0"/><geom size="0.1" pos="0 0 1"/>
<body name="c" pos="0 0 1"><joint axis="0 1 0"/><geom size="0.1" pos="0.5 0 0"/></body></body>
</worldbody><equality><connect body1="a" body2="c" anchor="0 0 1"/></equality></mujoco>
END
printf 'q.joint_0,q.joint_1,q.joint_2,v.joint_0,v.joint_1,v.joint_2,tau.joint_0,tau.joint_1,tau.joint_2\n0.3,0.3,-0.3,0,0,0,0,0,0\n' >states
expect 0 "" "$rbd_eval" loop.xml --algorithm constrained_fd --constraints loop.xml <states
has "lambda.2"

# The same torques from the file and from its URDF, and of the file's gravity.
printf '<mujoco model="p"><option gravity="0 0 -5"/><worldbody><body><joint name="j" axis="0 1 0"/><geom size="0.1" pos="1 0 0" mass="2"/></body></worldbody></mujoco>' >p.xml
printf 'q.j\n0\n' >states
expect 0 "" "$rbd_eval" p.xml --algorithm gravity_torque <states
has "-10"
sed 's/0 0 -5/0 0 -9.81/' p.xml >earth.xml
"$rbd_codegen" earth.xml --name p --algorithm id --output . && mv p_code.c earth_code.c
expect 0 "" "$rbd_codegen" p.xml --name p --algorithm id --output .
grep -q '19\.62' earth_code.c || fail "the code has no gravity"
grep -q '19\.62' p_code.c && fail "the code has another gravity than the file"

# The program of the page, where the compiler finds MuJoCo by itself.
if echo 'int main(void) { return 0; }' | ${CC:-cc} -x c - -lmujoco -o linked 2>out; then
    awk '$0 == "```c" { inside = 1; next } inside && /^```/ { exit } inside' "$root/docs/mjcf.md" >program.c
    cp "$files/joints.xml" robot.xml
    ${CC:-cc} -std=c99 -Dalways_inline=unused -Wall -Wextra -pedantic -Werror -I"$root" program.c -o program -lmujoco -lm ||
        fail "the program of docs/mjcf.md does not compile"
    expect 0 "" ./program
    has "joints: 26 degrees of freedom"
fi
exit $failed
