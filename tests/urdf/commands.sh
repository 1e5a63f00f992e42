#!/bin/sh
# rbd-model and rbd-eval as their user meets them: outputs, messages, exit statuses.
# usage: commands.sh ROOT RBD_MODEL RBD_EVAL
set -u
root=$(realpath "$1") rbd_model=$(realpath "$2") rbd_eval=$(realpath "$3")
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unforced=-Dalways_inline=unused # the header compiles in a quarter of the time without forced inlining
failed=0

fail() { echo "FAILED: $*"; failed=1; }

# expect STATUS MESSAGE COMMAND...: the exit status, and a line that standard error has ("" = nothing at all)
expect() {
    status=$1 message=$2
    shift 2
    "$@" >out 2>err </dev/null
    found=$?
    [ $found -eq "$status" ] || fail "exit status $found, not $status: $*"
    if [ -n "$message" ]; then
        grep -qxF -- "$message" err || { fail "no line '$message': $*"; cat err; }
    elif [ -s err ]; then
        fail "something on standard error: $*"
        cat err
    fi
}

# eval_row STATUS MESSAGE ROW...: rbd-eval on a table of these lines, the cart-pole's gravity torque
eval_row() {
    status=$1 message=$2
    shift 2
    printf '%s\n' "$@" >table
    "$rbd_eval" --model "$root/models/cart_pole.urdf" --algorithm gravity_torque <table >out 2>err
    found=$?
    [ $found -eq "$status" ] || fail "exit status $found, not $status: $*"
    [ -z "$message" ] || grep -qF -- "$message" err || { fail "no '$message': $*"; cat err; }
}

# constraints_row MESSAGE ROW...: rbd-eval refuses a table of constraints, a header of 29 columns and these lines
constraints_row() {
    message=$1
    shift
    frames=$(for body in 1 2; do
        printf 'body%s,x%s,y%s,z%s' $body $body $body $body
        for i in 0 1 2 3 4 5 6 7 8; do printf ',r%s_%s' $body $i; done
        printf ','
    done)
    printf '%s\n' "${frames}axes,kp,kd" "$@" >constraints
    expect 1 "rbd-eval: constraints: $message" "$rbd_eval" --model "$root/models/cart_pole.urdf" \
        --algorithm constrained_fd --constraints constraints --layout
}

# ---- arguments ----

for command in rbd-model rbd-eval; do
    [ $command = rbd-model ] && program=$rbd_model || program=$rbd_eval
    expect 0 "" "$program" --help
    grep -q "^usage: $command" out || fail "$command --help does not say how it is used"
    expect 0 "" "$program" --version
    grep -q "^$command [0-9]" out || fail "$command --version does not say which"
    expect 2 "$command: --gravity: '1,2' is not three numbers X,Y,Z; see $command --help" "$program" --gravity 1,2
    for option in --keep --root --root-joint; do
        expect 2 "$command: $option: its value is missing; see $command --help" "$program" $option
    done
    for option in --gravity=0,0,1 --root=a --root-joint=a; do
        expect 2 "$command: ${option%%=*}: it stands twice; see $command --help" "$program" $option a "${option%%=*}" 0,0,2
    done
    expect 2 "$command: --lock: 'x' in 'j=x' is not a number; see $command --help" "$program" --lock j=x
    expect 2 "$command: --lock: '' in 'j=' is not a number; see $command --help" "$program" --lock=j=
done
expect 2 "rbd-model: no file given; see rbd-model --help" "$rbd_model"
expect 2 "rbd-model: no file given (--lock takes a joint, --lock-massless nothing); see rbd-model --help" \
    "$rbd_model" --lock robot
expect 2 "rbd-model: more than one file: 'b'; see rbd-model --help" "$rbd_model" a b
expect 2 "rbd-model: unknown option '--x'; see rbd-model --help" "$rbd_model" --x
expect 2 "rbd-model: unknown option '--gravty=0,0,0'; did you mean '--gravity'? See rbd-model --help" "$rbd_model" --gravty=0,0,0
expect 2 "rbd-model: unknown option '-floating'; did you mean '--floating'? See rbd-model --help" "$rbd_model" -floating
expect 2 "rbd-model: unknown option '--c_model'; did you mean '--c-model'? See rbd-model --help" "$rbd_model" --c_model x
expect 2 "rbd-model: unknown option '--float'; did you mean '--floating'? See rbd-model --help" "$rbd_model" --float
expect 2 "rbd-eval: unknown option '--Model'; did you mean '--model'? See rbd-eval --help" "$rbd_eval" --Model
expect 2 "rbd-model: --c: '1x' is not a C identifier: it takes the name of the table; see rbd-model --help" "$rbd_model" --c 1x a
expect 2 "rbd-model: --urdf: there is only one output; see rbd-model --help" "$rbd_model" --c x --urdf a
expect 2 "rbd-eval: no file given; see rbd-eval --help" "$rbd_eval" --algorithm id
expect 2 "rbd-eval: --algorithm is missing; see rbd-eval --help" "$rbd_eval" --model a
expect 2 "rbd-eval: --algorithm: there is no 'ABA'; did you mean 'aba'? See rbd-eval --help" "$rbd_eval" --algorithm ABA
expect 2 "rbd-eval: --algorithm: there is no 'fdderivatives'; did you mean 'fd_derivatives'? See rbd-eval --help" \
    "$rbd_eval" --algorithm fdderivatives
expect 2 "rbd-eval: --algorithm: there is no 'kinematics'; see rbd-eval --help" "$rbd_eval" --algorithm kinematics
expect 2 "rbd-eval: --dt: it stands twice; see rbd-eval --help" "$rbd_eval" a --algorithm contact_step --dt 1 --dt=1
expect 2 "rbd-eval: --algorithm: it stands twice; see rbd-eval --help" "$rbd_eval" a --algorithm id --algorithm=fd
for option in "--body a" "--point 0,0,0" "--given a" "--constraints a" "--contacts a" "--dt 1"; do
    # shellcheck disable=SC2086 # an option and its value
    expect 2 "rbd-eval: ${option%% *}: 'id' does not take it; see rbd-eval --help" "$rbd_eval" a --algorithm id $option
done
for name in gravty gravity garvity; do
    expect 2 "rbd-eval: --algorithm: there is no '$name'; did you mean 'gravity_torque'? See rbd-eval --help" \
        "$rbd_eval" --algorithm $name
done
expect 2 "rbd-eval: '-': standard input has the table, so it cannot have the robot; see rbd-eval --help" \
    "$rbd_eval" --model - --algorithm id
for output in "--c x" --urdf --dot; do
    # shellcheck disable=SC2086 # an option and its value
    expect 2 "rbd-model: --gravity: only the built model has gravity (--c-model); see rbd-model --help" \
        "$rbd_model" a $output --gravity 0,0,0
done
expect 2 "rbd-eval: more than one file: 'b'; see rbd-eval --help" "$rbd_eval" --model a b
expect 0 "" "$rbd_eval" "$root/models/cart_pole.urdf" --algorithm mm --layout
grep -qx "takes q.hinge" out || fail "rbd-eval FILE"

# ---- rbd-model: files ----

cp "$root/tests/urdf/nasty.urdf" "$root/tests/urdf/broken/mass_negative.urdf" "$root"/models/*.urdf .
expect 1 "/no: error: it cannot be read: No such file or directory" "$rbd_model" /no
expect 1 "/: error: it cannot be read: Is a directory" "$rbd_model" /
expect 1 "-:1: error: it is empty" "$rbd_model" -
if [ "$(id -u)" -ne 0 ]; then # who may read everything
    cp iiwa.urdf mine.urdf && chmod 0 mine.urdf
    expect 1 "mine.urdf: error: it cannot be read: Permission denied" "$rbd_model" mine.urdf
fi
"$rbd_model" --check - <iiwa.urdf || fail "standard input"
expect 1 "mass_negative.urdf:4: error: link 'arm': the mass is negative" "$rbd_model" --check mass_negative.urdf
expect 1 "iiwa.urdf: error: there is no link 'hand' to keep" "$rbd_model" iiwa.urdf --keep hand
expect 0 "" "$rbd_model" --check iiwa.urdf
[ ! -s out ] || fail "--check prints something"
sed 's/ixx="1"/ixx="3"/' nasty.urdf >odd.urdf
triangle="inertia: one principal moment exceeds the sum of the others: no real body is like this"
expect 0 "odd.urdf:5: warning: link 'b', $triangle" "$rbd_model" --check odd.urdf
expect 1 "odd.urdf:3: error: link 'a*/??/\"\\é', $triangle" "$rbd_model" --check --strict odd.urdf
expect 0 "" "$rbd_model" odd.urdf
grep -qxF "line 5: link 'b', $triangle" out || fail "the summary does not have the warnings"

# what is not read is told by both, before the error that it leads to; with --strict it is the error
cp "$root/tests/urdf/odd/mimic_misspelt.urdf" misspelt.urdf
told="misspelt.urdf:7: warning: joint 'k': <mimc> is not read; did you mean <mimic>?"
expect 0 "$told" "$rbd_model" --check misspelt.urdf
expect 0 "$told" "$rbd_eval" misspelt.urdf --algorithm mm --layout
expect 1 "misspelt.urdf:7: error: joint 'k': <mimc> is not read; did you mean <mimic>?" \
    "$rbd_eval" misspelt.urdf --algorithm mm --layout --strict
sed 's/<link name="hand">/<lnk name="hand">/; s,^<lnk.*</link>$,&</lnk>,; s,</link></lnk>,</lnk>,' misspelt.urdf >missing.urdf
expect 1 "missing.urdf:6: error: joint 'k': its child link 'hand' is missing" "$rbd_model" --check missing.urdf
grep -qxF "missing.urdf:4: warning: <lnk> is not read; did you mean <link>?" err || fail "no warning before the error"

# ---- rbd-model: joints held still, a part of the robot ----

expect 1 "cart_pole.urdf: error: there is no joint 'hinges' to hold still; did you mean 'hinge'?" \
    "$rbd_model" cart_pole.urdf --lock hinges
expect 1 "cart_pole.urdf: error: there is no link 'poles' to be the root; did you mean 'pole'?" \
    "$rbd_model" cart_pole.urdf --root poles
expect 0 "cart_pole.urdf:22: warning: joint 'rail': held still at 3, beyond its limits -2 .. 2" \
    "$rbd_model" --lock=rail=3 cart_pole.urdf --check
expect 0 "" "$rbd_model" cart_pole.urdf --lock rail=0.5 --lock hinge=-1 --floating --root-joint free
grep -q "^cart_pole: 3 links, 1 body, 6 degrees of freedom" out || fail "--lock: not one body"
expect 0 "" "$rbd_model" cart_pole.urdf --root cart
grep -q "^cart_pole: 2 links, 1 body, 1 degree of freedom" out || fail "--root: not two links"
# the cart where it is held
printf 'q.hinge\n0\n' >table
"$rbd_eval" --model cart_pole.urdf --lock rail=0.5 --algorithm pose <table >out || fail "rbd-eval --lock"
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "p.pole.x") column = i } NR == 2 { exit !($column == 0.5) }' out ||
    { fail "rbd-eval --lock: the pole is elsewhere"; cat out; }

# --lock alone holds joints still that move no mass, as in 0.1.0, where nothing else can be meant
cat >massless.urdf <<'END'
<robot name="massless"><link name="a"/><link name="c"/><link name="b"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/></joint>
<joint name="k" type="continuous"><parent link="b"/><child link="c"/><axis xyz="1 0 0"/></joint></robot>
END
expect 1 "massless.urdf:4: error: link 'c', joint 'k', mass: a movable leaf needs mass, inertia or armature: forward \
dynamics would be singular; to hold it still: --lock 'k', or --lock-massless for all such; \
for kinematics alone, as poses and Jacobians: --kinematic" \
    "$rbd_model" massless.urdf
held="massless.urdf:4: warning: joint 'k': it moves no mass; held still"
expect 0 "$held" "$rbd_model" --check massless.urdf --lock-massless
expect 0 "$held" "$rbd_model" --check massless.urdf --lock
expect 0 "$held" "$rbd_model" --check --lock massless.urdf
expect 0 "$held" "$rbd_model" --lock --check massless.urdf
expect 0 "$held" "$rbd_eval" --lock --model massless.urdf --algorithm id --layout
expect 0 "" "$rbd_model" --check --lock k massless.urdf

# an arm without masses, with a gripper of which one finger mimics the other: read for kinematics alone
cat >bare.urdf <<'END'
<robot name="bare"><link name="base"/><link name="upper"/><link name="lower"/><link name="left"/><link name="right"/>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="2 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="finger" type="continuous"><parent link="lower"/><child link="left"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="other" type="continuous"><parent link="lower"/><child link="right"/><axis xyz="0 0 1"/>
<mimic joint="finger"/></joint></robot>
END
expect 1 "bare.urdf:2: error: no link that moves has mass: dynamics needs <inertial>; for kinematics alone, as poses and \
Jacobians: --kinematic" "$rbd_model" bare.urdf
expect 0 "" "$rbd_model" --kinematic --strict bare.urdf
grep -qx "for kinematics alone: joint shoulder moves no mass" out || { fail "no word of kinematics alone"; cat out; }
printf 'q.shoulder,q.elbow,q.finger\n0,1.5707963267948966,0\n' >table
"$rbd_eval" --kinematic bare.urdf --algorithm pose <table >out || fail "rbd-eval --kinematic"
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
         NR == 2 { x = $at["p.left.x"] - 2; y = $at["p.left.y"] - 1 }
         END { exit !(NR == 2 && x * x + y * y < 1e-24) }' out || { fail "the finger is elsewhere"; cat out; }
for algorithm in gravity_torque mm energy com; do
    sed -e 's/$/,0,0,0/' -e '1s/,0,0,0/,v.shoulder,v.elbow,v.finger/' table |
        "$rbd_eval" --kinematic bare.urdf --algorithm $algorithm >out 2>err && fail "$algorithm without masses"
    grep -qF "dynamics needs masses, and joint 'shoulder', which carries link 'upper', moves none: with --kinematic there \
are poses and Jacobians alone" err || { fail "$algorithm without masses:"; cat err; }
done
# rbd-eval takes such a robot by itself for kinematics, and names what dynamics lacks
"$rbd_eval" bare.urdf --algorithm pose <table >all 2>err || { fail "rbd-eval: poses without masses"; cat err; }
"$rbd_eval" --kinematic bare.urdf --algorithm pose <table >out
cmp -s out all || fail "rbd-eval: --kinematic makes other poses"
for algorithm in "jacobian --body left" "point --body left" rates integrate_derivatives difference_derivatives; do
    sed -e 's/$/,0,0,0,0,0,0/' -e '1s/,0,0,0,0,0,0/,v.shoulder,v.elbow,v.finger,a.shoulder,a.elbow,a.finger/' table |
        "$rbd_eval" bare.urdf --algorithm $algorithm >out 2>err || { fail "$algorithm without masses"; cat err; }
done
expect 1 "bare.urdf:2: error: no link that moves has mass: dynamics needs <inertial>; for kinematics alone, as poses and \
Jacobians: --kinematic" "$rbd_eval" bare.urdf --algorithm id --layout
expect 0 "massless.urdf:4: warning: joint 'k': it moves no mass; held still" \
    "$rbd_eval" --lock-massless massless.urdf --algorithm pose --layout
expect 1 "bare.urdf: error: lock_massless holds the joints still that kinematic lets move: give one of them" \
    "$rbd_model" --kinematic --lock-massless bare.urdf
"$rbd_model" --kinematic bare.urdf --c-model bare >bare_model.h && cat >bare.c <<'END'
#define RBD_IMPLEMENTATION
#define RBD_FEATURES BARE_FEATURES
#include "bare_model.h"
#include "rbd.h"
#include "bare_model.h"
int main(void) {
    static unsigned char memory[BARE_WORK_SIZE];
    const double q[3] = {0, 1, 0};
    double p[3], g[3];
    rbd_work *w;
    if (rbd_work_init(&bare_model, memory, sizeof memory, &w) || rbd_kinematics(&bare_model, w, q, NULL, NULL)) return 1;
    if (rbd_body_pose(&bare_model, w, BARE_BODY_LEFT, NULL, p) || !(p[0] > 2.5 && p[0] < 2.6)) return 2;
    return rbd_gravity_torque(&bare_model, w, q, g) != RBD_ERR_MASSLESS || rbd_singular_dof(w) != BARE_DOF_SHOULDER;
}
END
# shellcheck disable=SC2086 # CC may be "ccache cc"
${CC:-cc} -std=c99 $unforced -I"$root" -I. bare.c -o bare -lm && ./bare || fail "a table for kinematics alone: $?"
"$rbd_model" --kinematic bare.urdf --urdf >again.urdf && expect 0 "" "$rbd_model" --check --strict --kinematic again.urdf
"$rbd_model" --kinematic bare.urdf --c bare >out && grep -q "the description that rbd_model_build_kinematic takes" out ||
    fail "--c of a robot without masses"

# joints that mimic a missing one may move freely
sed 's/mimic joint="finger"/mimic joint="fingr"/' bare.urdf >wrong.urdf
expect 1 "wrong.urdf:5: error: joint 'other': it mimics 'fingr', which is missing; did you mean 'finger'?; to hold it still: \
--lock 'other'; to let all such joints move freely: --free-mimics" \
    "$rbd_model" --kinematic wrong.urdf
expect 0 "wrong.urdf:5: warning: joint 'other': it mimics 'fingr', which is missing; did you mean 'finger'?; it moves freely" \
    "$rbd_model" --check --kinematic --free-mimics wrong.urdf

# ---- rbd-model: the summary, line by line ----

expect 0 "" "$rbd_model" cart_pole.urdf
cat >expected <<'END'
cart_pole: 3 links, 2 bodies, 2 degrees of freedom (q has 2 numbers)
moving mass 1.7 kg

body  link      joint  type         axis  limits                    mass
      world            (the world)
   0    cart    rail   prismatic    x     -2 .. 2, v 5, effort 100  1.2 kg
   1      pole  hinge  continuous   -y    v 10, effort 50           0.5 kg

0 warnings
END
cmp -s expected out || { fail "the summary of the cart-pole"; diff expected out; }

free=" (--floating for a free base)"
expect 0 "" "$rbd_model" hyq.urdf
grep -q "^moving mass .*; fixed to the world .* kg$free$" out || fail "the summary does not name --floating"
expect 0 "" "$rbd_model" hyq.urdf --floating
grep -qF -e "$free" out && fail "the summary of a floating robot names --floating"
expect 0 "" "$rbd_model" nasty.urdf
grep -q "continuous = -2 k + 0.1  (0.6 0 0.8)" out || fail "the summary does not show what a joint mimics"

# ---- rbd-model: C tables of a robot with awkward names compile and build the same model ----

expect 0 "" "$rbd_model" nasty.urdf --c nasty && cp out nasty.h
expect 0 "" "$rbd_model" nasty.urdf --c-model nasty && cp out nasty_model.h
expect 0 "" "$rbd_model" nasty.urdf --c nasty
cmp -s out nasty.h || fail "the same file gave other bytes"
cat >program.c <<'END'
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "nasty.h"
#include "nasty_model.h"
#include <string.h>
int main(void)
{
    static unsigned char memory[RBD_MODEL_SIZE(NASTY_NB)], work[NASTY_WORK_SIZE];
    const double q[4] = {0.1, 0.2, 0.3, 0.4}, v[4] = {1, 2, 3, 4};
    double built[4], table[4];
    const rbd_model *m;
    rbd_work *w;
    if (rbd_model_build(nasty_bodies, NASTY_NB, memory, sizeof memory, &m, NULL) != RBD_OK) return 1;
    if (rbd_nb(m) != NASTY_NB || rbd_nq(m) != NASTY_NQ || rbd_nv(m) != NASTY_NV || NASTY_NV != 4) return 2;
    if (rbd_work_init(m, work, sizeof work, &w) != RBD_OK) return 3;
    if (rbd_rnea(m, w, q, v, v, NULL, built) != RBD_OK) return 4;
    if (rbd_work_init(&nasty_model, work, sizeof work, &w) != RBD_OK) return 5;
    if (rbd_rnea(&nasty_model, w, q, v, v, NULL, table) != RBD_OK) return 6;
    return memcmp(built, table, sizeof built) ? 7 : 0;
}
END
for standard in c99 c11; do
    # shellcheck disable=SC2086 # CC may be "ccache cc"
    ${CC:-cc} -std=$standard -pedantic -Wall -Wextra -Werror -O0 $unforced -ffp-contract=off -I"$root" -I. program.c \
        -o program -lm || fail "the tables do not compile as $standard"
    ./program || fail "the tables differ: $?"
done

# ---- the tables name the command that writes them again, to the byte; it ends no comment, whatever is in it ----

nasty_path="it's /* a */ ??/ \\ b"
mkdir -p -- "$nasty_path" && cp nasty.urdf "$nasty_path/again.urdf"
# again: the command that `out` names writes `out`
again() {
    eval "set -- $(sed -n "s/^       rbd-[a-z]* //p" out)"
    cp out before
    "$rbd_model" "$@" >out 2>err || fail "the command in a table fails: $*"
    cmp -s before out || { fail "the command in a table writes another: $*"; diff before out; }
}
expect 0 "" "$rbd_model" --gravity=0,0,-1.62 "$nasty_path/again.urdf" --c-model nasty --keep-all && again
expect 0 "" "$rbd_model" "$nasty_path/again.urdf" --c nasty && again
printf '#include "rbd.h"\n' | cat - out >again.c
# shellcheck disable=SC2086 # CC may be "ccache cc"
${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Wno-unused -Werror -I"$root" -c again.c -o again.o || fail "the command ends a comment"
expect 0 "" "$rbd_model" iiwa.urdf --c iiwa
grep -qxF "       rbd-model iiwa.urdf --c iiwa" out || fail "the command of the iiwa: $(sed -n 3p out)"
"$rbd_model" --c iiwa - <iiwa.urdf >out
grep -qxF "   Written by rbd-model from standard input: change that instead." out || fail "the head of standard input"

# ---- both tables size q, v and tau, and index them by name, in C and C++, two robots in one file ----

cat >names.urdf <<'END'
<robot name="names"><link name="base"/><link name="Left-arm"/><link name="left arm"/><link name="left_arm_2"/>
<link name="腕"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="a" type="floating"><parent link="base"/><child link="Left-arm"/></joint>
<joint name="a.qx" type="continuous"><parent link="Left-arm"/><child link="left arm"/><axis xyz="1 0 0"/></joint>
<joint name="3rd" type="continuous"><parent link="left arm"/><child link="left_arm_2"/><axis xyz="1 0 0"/></joint>
<joint name="-" type="continuous"><parent link="left_arm_2"/><child link="腕"/><axis xyz="1 0 0"/></joint>
<link name="finger"/><joint name="follow" type="continuous"><parent link="base"/><child link="finger"/><axis xyz="1 0 0"/>
<mimic joint="3rd"/></joint></robot>
END
expect 0 "" "$rbd_model" names.urdf --c names && cp out names.h
expect 0 "" "$rbd_model" names.urdf --c-model names && cp out names_model.h
expect 0 "" "$rbd_model" hyq.urdf --floating --c-model hyq && cp out hyq_model.h
cat >indices.c <<'END'
#include "rbd.h"
#define HYQ_MODEL_IMPLEMENTATION
#define NAMES_MODEL_IMPLEMENTATION
#include "hyq_model.h"
#ifdef DESCRIPTION_FIRST
#include "names.h"
#include "names_model.h"
#elif defined DESCRIPTION
#include "names.h"
#else
#include "names_model.h"
#include "names.h"
#endif
#include <stdio.h>
#include <string.h>

static rbd_real q[NAMES_NQ], v[NAMES_NV], tau[NAMES_NV];
#if NAMES_NB != 5 || NAMES_NQ != 10 || NAMES_NV != 9 || HYQ_NB != 13 || HYQ_NQ != 19 || HYQ_NV != 18
#error "sizes"
#endif
/* what a switch takes is a constant of the compiler */
static int is_of_hand(int dof) {
    switch (dof) {
    case NAMES_DOF_3RD: case NAMES_DOF_8: return 1;
    default: return 0;
    }
}
static int differ(int index, int expected, const char *name) {
    if (index != expected) printf("%s: %d, not %d\n", name, index, expected);
    return index != expected;
}
#define DIFFERS(index, expected) differ(index, expected, #index)
int main(void) {
    int bad = 0;
    q[NAMES_Q_A_QW] = 1, v[NAMES_DOF_A_VX] = 2, tau[NAMES_DOF_A_QX] = 3;
    bad += DIFFERS(q[6] == 1 && v[3] == 2 && tau[6] == 3 && is_of_hand(7) && is_of_hand(8) && !is_of_hand(6), 1);
    bad += DIFFERS(NAMES_BODY_LEFT_ARM, 0) + DIFFERS(NAMES_BODY_LEFT_ARM_3, 1) + DIFFERS(NAMES_BODY_LEFT_ARM_2, 2);
    bad += DIFFERS(NAMES_BODY_3, 3) + DIFFERS(NAMES_BODY_FINGER, 4);
    bad += DIFFERS(NAMES_Q_A_X, 0) + DIFFERS(NAMES_Q_A_QX, 3) + DIFFERS(NAMES_Q_A_QX_2, 7) + DIFFERS(NAMES_Q_9, 9);
    bad += DIFFERS(NAMES_DOF_A_WX, 0) + DIFFERS(NAMES_DOF_A_VZ, 5) + DIFFERS(NAMES_DOF_A_QX, 6);
    bad += DIFFERS(HYQ_Q_ROOT_QW, 6) + DIFFERS(HYQ_DOF_ROOT_WX, 0) + DIFFERS(HYQ_BODY_LF_LOWERLEG, 9);
    bad += DIFFERS(rbd_body_index(&hyq_model, "rh_lowerleg"), HYQ_BODY_RH_LOWERLEG);
    for (int b = 0; b < HYQ_NB; b++) {
        rbd_joint_info j;
        rbd_joint(&hyq_model, b, &j);
        if (strcmp(rbd_joint_name(&hyq_model, b), "lh_hfe_joint") == 0)
            bad += DIFFERS(HYQ_Q_LH_HFE_JOINT, j.iq) + DIFFERS(HYQ_DOF_LH_HFE_JOINT, j.iv);
    }
#ifndef DESCRIPTION
    bad += DIFFERS(rbd_nv(&names_model), NAMES_NV);
#endif
    bad += DIFFERS(strcmp(names_bodies[NAMES_BODY_LEFT_ARM_3].name, "left arm") == 0, 1);
    return bad;
}
END
printf '#define RBD_IMPLEMENTATION\n#include "rbd.h"\n' >library.c
# shellcheck disable=SC2086 # CC may be "ccache cc"
${CC:-cc} -std=c99 $unforced -I"$root" -c library.c -o library.o || fail "the library does not compile"
for language in "-x c -std=c99" "-x c -std=c11" "-x c++ -std=c++11" "-x c++ -std=c++20"; do
    for tables in BOTH DESCRIPTION_FIRST DESCRIPTION; do
        # shellcheck disable=SC2086 # CC may be "ccache cc"; a language is two words
        ${CC:-cc} $language -pedantic -Wall -Wextra -Wconversion -Werror -D$tables -I"$root" -I. indices.c \
            -x none library.o -o indices -lm || fail "indices by name do not compile: $language $tables"
        ./indices || fail "indices by name: $language $tables"
    done
done

# the snippet of the README, on a robot with an elbow
cat >arm.urdf <<'END'
<robot name="arm"><link name="base"/><link name="upper"/><link name="forearm"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="forearm"/><axis xyz="0 1 0"/></joint></robot>
END
expect 0 "" "$rbd_model" arm.urdf --c-model robot && cp out robot_model.h
awk '/^    #include "rbd.h"/ { inside = 1 } inside && !/^    / { exit } inside' "$root/README.md" >snippet
grep -q robot_model.h snippet || fail "README.md has no snippet for firmware"
{
    grep -E '^ *(#|static)' snippet
    echo 'double encoder(int); void motor(int, double); int main(void);'
    echo 'double encoder(int i) { return i; } void motor(int i, double tau) { (void)i, (void)tau; }'
    echo 'int main(void) {'
    grep -vE '^ *(#|static)' snippet
    echo 'return ROBOT_NB - ROBOT_BODY_FOREARM != 1; }'
} >firmware.c
# shellcheck disable=SC2086 # CC may be "ccache cc"
${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Werror -I"$root" -I. firmware.c library.o -o firmware -lm
./firmware || { fail "the snippet of README.md"; cat firmware.c; }

# a table before rbd.h, or of another version, says so
printf '#include "nasty_model.h"\n#include "rbd.h"\n' >late.c
# shellcheck disable=SC2086 # CC may be "ccache cc"
${CC:-cc} -I"$root" -I. -c late.c -o late.o 2>err && fail "a table before rbd.h compiles"
grep -qF "include rbd.h before nasty_model.h" err || { fail "a table before rbd.h"; cat err; }
grep -qF "another version" err && fail "a table before rbd.h says that it is of another version"
sed 's/RBD_MODEL_VERSION != [0-9]*/RBD_MODEL_VERSION != 0/' nasty_model.h >old_model.h
printf '#include "rbd.h"\n#include "old_model.h"\n' >old.c
# shellcheck disable=SC2086
${CC:-cc} -I"$root" -I. -c old.c -o old.o 2>err && fail "a table of another version compiles"
grep -qF "nasty_model.h was written for another version" err || { fail "a table of another version"; cat err; }

# ---- rbd-model --urdf: read back, it is the same robot ----

for robot in iiwa "hyq --floating" "atlas --floating" cart_pole; do
    name=${robot% *} option=${robot#"${robot% *}"}
    # shellcheck disable=SC2086 # no option is none
    expect 0 "" "$rbd_model" $name.urdf $option --urdf && mkdir -p back && cp out back/$name.urdf
    # shellcheck disable=SC2086
    expect 0 "" "$rbd_model" --strict back/$name.urdf $option --c x && grep -v '^       rbd-model' out >back.h
    # shellcheck disable=SC2086
    expect 0 "" "$rbd_model" $name.urdf $option --c x
    grep -v '^       rbd-model' out | cmp -s - back.h || fail "$name is another robot after --urdf"
done
expect 0 "" "$rbd_model" nasty.urdf --urdf && cp out merged.urdf
{
    "$rbd_eval" --model nasty.urdf --algorithm fd_cholesky --layout | sed -n 's/^takes //p' | paste -sd, -
    echo 0.1,0.2,0.3,0.4,1,2,3,4,5,6,7,8
} >table
"$rbd_eval" --model nasty.urdf --algorithm fd_cholesky <table >a.csv || fail "rbd-eval on nasty.urdf"
"$rbd_eval" --model merged.urdf --algorithm fd_cholesky <table >b.csv || fail "rbd-eval on merged.urdf"

# same_numbers A B: whether two tables have one row each and finite numbers in it, the same to 1e-12
same_numbers() {
    awk -F, 'FNR == 2 && /[nN][aA][nN]|[iI][nN][fF]/ { bad = 1 }
             NR == FNR { rows = NR; cells[NR] = NF; for (i = 1; i <= NF; i++) first[NR, i] = $i; next }
             NF != cells[FNR] { bad = 1 }
             FNR == 2 { for (i = 1; i <= NF; i++) if ((d = $i - first[2, i]) > 1e-12 || d < -1e-12) bad = 1 }
             END { exit bad || rows != 2 || FNR != 2 }' "$1" "$2"
}
same_numbers a.csv b.csv || { fail "--urdf gave another robot"; cat a.csv b.csv; }
printf 'x,y\n1,2\n' >one.csv
same_numbers one.csv one.csv || fail "same_numbers refuses the same numbers"
for other in 'x,y\n1,nan\n' 'x,y\n1,-inf\n' 'x,y\n1\n' 'x,y\n1,2,3\n' 'x,y\n1,2.1\n' 'x,y\n' 'x,y\n1,2\n1,2\n'; do
    # shellcheck disable=SC2059 # with \n
    printf "$other" >other.csv
    same_numbers one.csv other.csv && fail "same_numbers takes $other for 1,2"
    same_numbers other.csv one.csv && fail "same_numbers takes 1,2 for $other"
done
printf 'x,y\n1,nan\n' >other.csv
same_numbers other.csv other.csv && fail "same_numbers takes nan for a number"

# near a pitch of 90 degrees roll and yaw are nearly one angle
printf "q.j\n0.3\n" >table
for pitch in 1.5707963 1.570796325 -1.5707963267 1.57079632679 1.5707963267948966 -1.5707963267948966 1.2; do
    sed "s/<axis/<origin rpy=\"0.3 $pitch 0.7\"\/><axis/" \
        "$root/tests/urdf/odd/axis_not_unit.urdf" >pitch.urdf
    "$rbd_model" pitch.urdf --urdf >turned.urdf 2>err || fail "--urdf at a pitch of $pitch"
    for file in pitch turned; do "$rbd_eval" $file.urdf --algorithm pose <table >$file.csv 2>err; done
    same_numbers pitch.csv turned.csv || { fail "--urdf at a pitch of $pitch"; cat pitch.csv turned.csv; }
done

# a link that is to have no mass says so when it is written anew
"$rbd_model" "$root/tests/urdf/odd/link_without_inertial.urdf" --urdf >massless.urdf 2>err
expect 0 "" "$rbd_model" --check --strict massless.urdf

# names that --urdf makes up are new: the links j_plane and j_plane_, the joint b_upright are there
cat >taken.urdf <<'END'
<robot name="taken"><link name="j_plane"/>
<link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<link name="j_plane_"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
</link>
<joint name="j" type="planar"><parent link="j_plane"/><child link="b"/><axis xyz="0 1 0"/></joint>
<joint name="b_upright" type="continuous"><parent link="j_plane"/><child link="j_plane_"/><axis xyz="1 0 0"/></joint></robot>
END
expect 0 "" "$rbd_model" taken.urdf --urdf && cp out back/taken.urdf
expect 0 "" "$rbd_model" --check back/taken.urdf
grep -qF 'link name="j_plane__"' back/taken.urdf || fail "the plane of j is not called j_plane__"
grep -qF 'joint name="b_upright_"' back/taken.urdf || fail "the joint that sets b upright is not called b_upright_"

# ---- rbd-model --dot ----

expect 0 "" "$rbd_model" cart_pole.urdf --dot
grep -qF 'n0 -> n1 [label="rail\nprismatic"];' out || fail "--dot does not have the rail"
[ "$(grep -c -- '->' out)" -eq 2 ] || fail "--dot does not have two joints"

# ---- rbd-eval: tables, good and bad ----

eval_row 1 "row 1: column 'q.rail' is missing (--layout prints all); is 'q.rial' meant for it?" "q.hinge,q.rial" "0,0"

eval_row 0 "" "q.hinge,q.rail" "0,0" "" "0.5,1"
[ "$(wc -l <out)" -eq 3 ] || fail "two rows in, not two out"
[ "$(sed -n 1p out)" = tau.rail,tau.hinge ] || fail "names of gravity's results"
[ "$(sed -n 2p out)" = 0,0 ] || fail "gravity of a hanging pole"
eval_row 0 "" "q.hinge,q.rail"
[ "$(cat out)" = tau.rail,tau.hinge ] || fail "no names of the results of no rows"
eval_row 1 "no header: the table is empty"
missing="row 1: column 'q.rail' is missing (--layout prints all); found, between commas:"
eval_row 1 "$missing 'q.hinge', 'x'" "q.hinge,x" "0,0"
parted="and no commas: cells are parted by commas, numbers have points"
eval_row 1 "row 1: it has semicolons $parted" "q.rail;q.hinge" "0,5;0"
eval_row 1 "row 1: it has tabs $parted" "q.rail	q.hinge" "0	0"
long=$(printf '%0100d' 0)
eval_row 1 "$missing '$long', ..." "$long,$long" "0,0"
eval_row 1 "$missing ..." "$long$long" "0"
eval_row 1 "row 1: column 'q.rail' stands twice" "q.rail,q.hinge,q.rail" "0,0,0"
eval_row 1 "row 3: column 'q.rail': 'one' is not a finite number" "q.rail,q.hinge" "0,0" "one,0"
eval_row 1 "row 2: column 'q.hinge': 'nan' is not a finite number" "q.rail,q.hinge" "0,nan"
eval_row 1 "row 2: column 'q.hinge': '' is not a finite number" "q.rail,q.hinge" "0,"
eval_row 1 "row 2: it has 1 cell, the header 2" "q.rail,q.hinge" "0"
[ ! -s out ] || fail "names of results stand before an error in the first row"
eval_row 1 "row 2: it has 3 cells, the header 2" "q.rail,q.hinge" "0,0,0"
eval_row 1 "row 2: a quote is not closed" "q.rail,q.hinge" '0,"0'
eval_row 1 "row 2: something follows a closing quote" "q.rail,q.hinge" '0,"0"0'

# what is no text, and what cannot be read, at the start of the table and within it
printf 'q.rail,q.hinge\n0,0\n0,1\0junk\n' >zero
"$rbd_eval" --model cart_pole.urdf --algorithm gravity_torque <zero >out 2>err && fail "a zero byte cuts a row"
grep -qxF "rbd-eval: row 3: it has a zero byte" err || { fail "a zero byte"; cat err; }
printf 'q.rail,q.hinge\n0,0\n' | iconv -t UTF-16 >table
"$rbd_eval" --model cart_pole.urdf --algorithm gravity_torque <table >out 2>err && fail "UTF-16 is taken for a table"
grep -qxF "rbd-eval: row 1: it has a zero byte; a text in UTF-16 must be saved as UTF-8" err || { fail "UTF-16"; cat err; }

# finite numbers whose result is none
printf 'q.rail,q.hinge,v.rail,v.hinge,a.rail,a.hinge\n0,1,0,1e200,0,0\n' >table
"$rbd_eval" --model cart_pole.urdf --algorithm id <table >out 2>err && fail "a result that overflows"
grep -qxF "rbd-eval: row 2: the result 'tau.rail' overflows" err || { fail "an overflow"; cat err; }
[ ! -s out ] || fail "a result that overflows is printed"
"$rbd_eval" --model cart_pole.urdf --algorithm gravity_torque </ >out 2>err && fail "a folder is taken for a table"
grep -q "^rbd-eval: row 1: it cannot be read: " err || { fail "a read error"; cat err; }

# ---- rbd-eval: tables of constraints ----

expect 2 "rbd-eval: --constraints is missing: constrained_fd takes a table of them; see rbd-eval --help" \
    "$rbd_eval" --model a --algorithm constrained_fd
expect 1 "rbd-eval: nowhere.csv: No such file or directory" \
    "$rbd_eval" --model "$root/models/cart_pole.urdf" --algorithm constrained_fd --constraints nowhere.csv --layout
same=1,0,0,0,1,0,0,0,1
constraints_row "row 2: column 'body1': the robot has no link 'leg'" "leg,0,0,0,$same,world,0,0,0,$same,000111,0,0"
constraints_row "row 2: column 'body2': the robot has no link 'polw'; did you mean 'pole'?" "cart,0,0,0,$same,polw,0,0,0,$same,000111,0,0"
constraints_row "row 2: column 'body1': the robot has no link ''" ",0,0,0,$same,cart,0,0,0,$same,000111,0,0"
constraints_row "row 2: column 'axes': '0001112' is not six characters 0 or 1" \
    "pole,0,0,0,$same,world,0,0,0,$same,0001112,0,0"
constraints_row "row 2: column 'axes': '111' is not six characters 0 or 1; did a spreadsheet take leading zeros away?" \
    "pole,0,0,0,$same,world,0,0,0,$same,111,0,0"
constraints_row "row 2: column 'r2_4' is missing or empty: a rotation has nine numbers, or none" \
    "pole,0,0,0,$same,world,0,0,0,1,0,0,0,,0,0,0,1,000111,0,0"
constraints_row "row 2: column 'axes': '00011' is not six characters 0 or 1; did a spreadsheet take leading zeros away?" \
    "pole,0,0,0,$same,world,0,0,0,$same,00011,0,0"
constraints_row "row 3: column 'z2': 'up' is not a finite number" "pole,0,0,0,$same,world,0,0,0,$same,000111,0,0" \
    "pole,0,0,0,$same,world,0,0,up,$same,000111,0,0"
constraints_row "row 2: it has 3 cells, the header 29" "pole,0,0"
constraints_row "row 2: axes: none is held, or one is neither 0 nor 1" \
    "pole,0,0,0,$same,world,0,0,0,$same,000000,0,0"
constraints_row "row 4: kd: negative, not finite or out of range" "pole,0,0,0,$same,world,0,0,0,$same,000001,0,0" "" \
    "pole,0,0,0,$same,world,0,0,0,$same,000001,0,-1"
# header MESSAGE NAMES: a table with these columns is refused
header() {
    printf '%s\n' "$2" >constraints
    expect 1 "rbd-eval: constraints: row 1: $1" "$rbd_eval" --model "$root/models/cart_pole.urdf" \
        --algorithm constrained_fd --constraints constraints --layout
}
header "column 'axes' is missing" body1,x1
header "column 'body1' is missing" axes,body2
header "column 'kp' stands twice" body1,kp,axes,kp
header "column 'axis' is unknown; did you mean 'axes'?" body1,axis
header "column 'Body1' is unknown; did you mean 'body1'?" Body1,axes
header "column 'r1-0' is unknown; did you mean 'r1_0'?" body1,axes,r1-0
header "column 'colour' is unknown" body1,axes,colour
header "column '' is unknown" body1,axes,
: >constraints
expect 1 "rbd-eval: constraints: row 1: no header: the table is empty" "$rbd_eval" --model "$root/models/cart_pole.urdf" \
    --algorithm constrained_fd --constraints constraints --layout

# ---- rbd-eval: tables of contacts ----

# a ball of 2 kg on the ground: it slides, rests, and is lifted; g = 9.81 m/s^2, 1 ms
cat >ball.urdf <<'end'
<robot name="ball"><link name="ball"><inertial><mass value="2"/>
  <inertia ixx="0.008" ixy="0" ixz="0" iyy="0.008" iyz="0" izz="0.008"/></inertial></link></robot>
end
printf '%s\n' 'name,body1,friction,radius,height' 'ground,ball,0.5,0.1,0.2' ',ball,,,-3' >contacts
position=q.root.x,q.root.y,q.root.z,q.root.qx,q.root.qy,q.root.qz,q.root.qw
velocity=root.wx,root.wy,root.wz,root.vx,root.vy,root.vz
{
    printf '%s,v.%s,tau.%s\n' $position "$(echo $velocity | sed 's/,/,v./g')" "$(echo $velocity | sed 's/,/,tau./g')"
    printf '0,0,0.3,0,0,0,1,0,0,0,%s\n' 1,0,0,0,0,0,0,0,0 0,0,0,0,0,0,0,0,0 0,0,0,0,0,0,0,0,30
} >table
for name in contact contact_step; do
    "$rbd_eval" ball.urdf --floating --algorithm $name --contacts contacts --dt 0.001 <table >out 2>err || fail "a ball: $(cat err)"
    awk -F, 'function is(name, x) { if ((cell[column[name]] - x) ^ 2 > 1e-16) { print name " is not " x; bad = 1 } }
        NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
        { split($0, cell); is("residual", 0); is("contact.1.state", 0) }
        NR == 2 { is("contact.ground.state", 3); is("contact.ground.fx", -9.81); is("contact.ground.fz", 19.62)
                  is("v_next.root.vx", 1 - 0.5 * 9.81e-3); is("q_next.root.z", 0.3) }
        NR == 3 { is("contact.ground.state", 2); is("contact.ground.fx", 0); is("contact.ground.fz", 19.62)
                  is("v_next.root.vz", 0) }
        NR == 4 { is("contact.ground.state", 1); is("contact.ground.fz", 0)
                  is("v_next.root.vz", 1e-3 * (15 - 9.81)) }
        END { exit NR != 4 || bad }' out || { fail "a ball on the ground, $name"; cat out; }
done
expect 2 "rbd-eval: --contacts is missing: contact_step takes a table of them; see rbd-eval --help" \
    "$rbd_eval" ball.urdf --algorithm contact
expect 2 "rbd-eval: --dt: '0' is not a number above 0; see rbd-eval --help" "$rbd_eval" ball.urdf --dt 0
expect 1 "rbd-eval: nowhere.csv: No such file or directory" \
    "$rbd_eval" ball.urdf --floating --algorithm contact --contacts nowhere.csv --layout
# contacts MESSAGE ROW...: a table of these lines is refused
contacts() {
    message=$1
    shift
    printf '%s\n' "$@" >contacts
    expect 1 "rbd-eval: contacts: $message" "$rbd_eval" ball.urdf --floating --algorithm contact --contacts contacts --layout
}
contacts "row 1: column 'body1' is missing" x,y,z
contacts "row 1: column 'frictoin' is unknown; did you mean 'friction'?" body1,frictoin
contacts "row 1: column 'x' stands twice" body1,x,x
contacts "row 2: it has 1 cell, the header 2" body1,x ball
contacts "row 2: column 'body1': the robot has no link 'bal'; did you mean 'ball'?" body1,x bal,0
contacts "row 3: column 'friction': 'much' is not a finite number" body1,friction ball,1 ball,much
contacts "row 3: friction: negative, not finite or out of range" body1,friction ball,1 ball,-1
contacts "row 2: restitution: negative, not finite or out of range" body1,restitution ball,2
contacts "row 3: column 'name': 'toe' stands twice" name,body1 toe,ball toe,ball
contacts "row 3: column 'name': '1' stands twice" name,body1 1,ball ,ball
contacts "row 2: column 'name': it has more than 63 characters" name,body1 "$(printf '%064d' 0),ball"
printf 'body1,axes\nball,000000\n' >constraints
printf 'body1\nball\n' >contacts
expect 1 "rbd-eval: constraints: row 2: axes: none is held, or one is neither 0 nor 1" \
    "$rbd_eval" ball.urdf --floating --algorithm contact --contacts contacts --constraints constraints --layout

# what a table leaves out is the world, 0 and the identity
printf 'q.rail,q.hinge,v.rail,v.hinge,tau.rail,tau.hinge\n0.1,0.2,0.3,0.4,5,6\n' >table
# held COLUMNS ROW...: the cart-pole under these constraints
held() {
    printf '%s\n' "$@" >constraints
    "$rbd_eval" --model cart_pole.urdf --algorithm constrained_fd --constraints constraints <table >out || fail "constraints: $*"
}
held "$(for body in 1 2; do
    printf 'body%s,x%s,y%s,z%s,' $body $body $body $body
    for i in 0 1 2 3 4 5 6 7 8; do printf 'r%s_%s,' $body $i; done
done)axes,kp,kd" "pole,0,0,-0.5,$same,world,0,0,0,$same,000100,0,3"
cp out full
held body1,z1,axes,kd pole,-0.5,000100,3
cmp -s out full || { fail "columns that are left out"; diff out full; }
held axes,kd,z1,body1,body2,kp,r1_0,r1_1,r1_2,r1_3,r1_4,r1_5,r1_6,r1_7,r1_8 000100,3,-0.5,pole,,,,,,,,,,,
cmp -s out full || { fail "cells that are empty"; diff out full; }
held body1,z1,axes,kd,r2_0,r2_1,r2_2,r2_3,r2_4,r2_5,r2_6,r2_7,r2_8 pole,-0.5,010000,3,0,-1,0,1,0,0,0,0,1
cmp -s out full && fail "columns of a rotation make no difference"

# ---- rbd-model: the same tables as C ----

printf 'body1,x1\npole,0\n' >constraints
expect 1 "rbd-model: constraints: row 1: column 'axes' is missing" "$rbd_model" "$root/models/cart_pole.urdf" \
    --c-model held --constraints constraints
[ -s out ] && fail "a table of a robot without its constraints"
expect 2 "rbd-model: --constraints: only a C table has them (--c, --c-model); see rbd-model --help" \
    "$rbd_model" "$root/models/cart_pole.urdf" --check --constraints constraints
printf '%s\n' "${frames}axes,kp,kd" "pole,0.25,0,0.5,$same,world,0,0,0,$same,000001,7,0" >constraints
expect 0 "" "$rbd_model" "$root/models/cart_pole.urdf" --c-model held --constraints constraints && cp out held_model.h
cat >held.c <<'END'
#define RBD_IMPLEMENTATION
#include "rbd_constraints.h"
#include "held_model.h"
static unsigned char work[HELD_WORK_SIZE], memory[RBD_CONSTRAINT_SET_SIZE(HELD_NV, HELD_ROWS)];
int main(void) {
    const rbd_constraint *k = &held_constraints[0];
    rbd_work *w;
    rbd_constraint_set *c;
    if (rbd_work_init(&held_model, work, sizeof work, &w)) return 1;
    if (rbd_constraint_set_init(&held_model, w, k, HELD_CONSTRAINTS, memory, sizeof memory, &c, NULL)) return 2;
    return !(HELD_ROWS == 1 && rbd_constraint_rows(c) == 1 && k->body1 == HELD_BODY_POLE && k->body2 == -1 &&
             k->position1[0] == 0.25 && k->position1[2] == 0.5 && k->axes[5] == 1 && k->axes[4] == 0 && k->kp == 7 &&
             k->rotation2[8] == 1);
}
END
# shellcheck disable=SC2086 # CC may be "ccache cc"
${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Werror $unforced -I"$root" -I. held.c -o held -lm && ./held || fail "held_model.h"

# a link on a fixed joint is no body, unless it is kept
cat >fixed.urdf <<'END'
<robot name="fixed"><link name="base"/><link name="arm"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0"
iyy="1" iyz="0" izz="1"/></inertial></link><link name="tip"/>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="1 0 0"/></joint>
<joint name="k" type="fixed"><parent link="arm"/><child link="tip"/></joint></robot>
END
printf 'body1,axes\ntip,000111\n' >constraints
expect 1 "rbd-model: constraints: row 2: column 'body1': link 'tip' is fixed to arm and no body of its own; for that: --keep tip" \
    "$rbd_model" fixed.urdf --c held --constraints constraints
expect 0 "" "$rbd_model" fixed.urdf --c held --constraints constraints --keep tip
printf 'body1,body2,axes\narm,base,000111\n' >constraints
expect 1 "rbd-model: constraints: row 2: column 'body2': link 'base' is fixed to the world and no body of its own; for that: \
--keep base" "$rbd_model" fixed.urdf --c held --constraints constraints

for pair in rnea=id crba=mm aba=fd; do
    "$rbd_eval" --model cart_pole.urdf --algorithm "${pair%=*}" --layout >a.txt || fail "--algorithm ${pair%=*}"
    "$rbd_eval" --model cart_pole.urdf --algorithm "${pair#*=}" --layout >b.txt
    cmp -s a.txt b.txt || fail "$pair"
done
expect 1 "mass_negative.urdf:4: error: link 'arm': the mass is negative" \
    "$rbd_eval" --model mass_negative.urdf --algorithm id

# a singular system is named: two joints on one axis with nothing between
cat >singular.urdf <<'END'
<robot name="singular"><link name="a"/><link name="b"/><link name="c"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/></joint>
<joint name="k" type="continuous"><parent link="b"/><child link="c"/><axis xyz="1 0 0"/></joint></robot>
END
printf 'q.j,q.k,v.j,v.k,tau.j,tau.k\n1,2,3,4,5,6\n' >table
"$rbd_eval" --model singular.urdf --algorithm fd <table >out 2>err && fail "a singular system gave a result"
grep -q "^rbd-eval: row 2: the mass matrix is singular, at [jk]$" err || { fail "singular"; cat err; }

# a point of a link, also of one without mass, and the names of rows
expect 2 "rbd-eval: --body is missing: jacobian takes a point of a link; see rbd-eval --help" \
    "$rbd_eval" --model cart_pole.urdf --algorithm jacobian
expect 2 "rbd-eval: --point: '1,2,3,' is not three numbers X,Y,Z; see rbd-eval --help" \
    "$rbd_eval" --model cart_pole.urdf --algorithm jacobian --body pole --point 1,2,3,
expect 1 "rbd-eval: --body: the robot has no link 'pole2'; did you mean 'pole'?" \
    "$rbd_eval" --model cart_pole.urdf --algorithm jacobian --body pole2
expect 1 "rbd-eval: --body: the robot has no link 'ploe'; did you mean 'pole'?" \
    "$rbd_eval" --model cart_pole.urdf --algorithm jacobian --body ploe
expect 1 "rbd-eval: --body: the robot has no link 'arm'" \
    "$rbd_eval" --model cart_pole.urdf --algorithm jacobian --body arm
printf 'q.rail,q.hinge\n5,0\n' |
    "$rbd_eval" --model cart_pole.urdf --algorithm jacobian --body pole --point 0,0,-2 >out || fail "jacobian"
[ "$(sed -n 1p out)" = J.wx.rail,J.wx.hinge,J.wy.rail,J.wy.hinge,J.wz.rail,J.wz.hinge,J.vx.rail,J.vx.hinge,\
J.vy.rail,J.vy.hinge,J.vz.rail,J.vz.hinge ] || fail "names of a Jacobian"
[ "$(sed -n 2p out)" = 0,0,0,-1,0,0,1,2,0,0,0,0 ] || { fail "the Jacobian of a hanging pole"; cat out; }

# degrees of freedom whose acceleration is given, by name or by joint
expect 1 "rbd-eval: --given: the robot has no degree of freedom 'lf_hfe'" \
    "$rbd_eval" --model hyq.urdf --floating --algorithm hybrid --given lf_hfe
expect 1 "rbd-eval: --given: the robot has no degree of freedom 'lf_hfe_jiont'; did you mean 'lf_hfe_joint'?" \
    "$rbd_eval" --model hyq.urdf --floating --algorithm hybrid --given lf_hfe_jiont
expect 1 "rbd-eval: --given: the robot has no degree of freedom 'root.w'; did you mean 'root.wx'?" \
    "$rbd_eval" --model hyq.urdf --floating --algorithm hybrid --given root.w
"$rbd_eval" --model hyq.urdf --floating --algorithm hybrid --layout >layout || fail "hybrid"
{
    sed -n 's/^takes //p' layout | paste -sd, -
    sed -n 's/^takes //p' layout | sed 's/.*qw/1/; t; s/.*/0/' | paste -sd, -
} >table
"$rbd_eval" --model hyq.urdf --floating --algorithm hybrid --given root <table >a.csv || fail "--given a joint"
"$rbd_eval" --model hyq.urdf --floating --algorithm hybrid --given root.wx --given root.wy --given=root.wz \
    --given root.vx --given root.vy --given root.vz <table >b.csv || fail "--given six names"
cmp a.csv b.csv || fail "a joint's name is not all of its"
[ "$(sed -n 2p a.csv | cut -d, -f1-6)" = 0,0,0,0,0,0 ] || fail "the given accelerations are not what was given"

# names of a floating base
"$rbd_eval" --model hyq.urdf --floating --algorithm fd --layout >layout || fail "--layout"
[ "$(sed -n 's/^takes q.root.//p' layout | paste -sd' ' -)" = "x y z qx qy qz qw" ] || fail "coordinates of root"
[ "$(sed -n 's/^takes v.root.//p' layout | paste -sd' ' -)" = "wx wy wz vx vy vz" ] || fail "velocity of root"
[ "$(sed -n 's/^gives a.root.//p' layout | paste -sd' ' -)" = "wx wy wz vx vy vz" ] || fail "acceleration of root"
[ "$(wc -l <layout)" -eq $((19 + 18 + 18 + 18)) ] || fail "length of the layout"

exit $failed
