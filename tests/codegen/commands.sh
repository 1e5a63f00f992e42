#!/bin/sh
# rbd-codegen as its user meets it: files, self-tests, messages, exit statuses.
# usage: commands.sh ROOT RBD_CODEGEN   with RBD_ALL_TESTS=yes a result is changed in every self-test, else in one of each kind,
#     and more of each kind: a chain in double, pairs of limbs with constraints, reproducible code without lanes, sums by x87
set -u
root=$(realpath "$1") rbd_codegen=$(realpath "$2")
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
failed=0

fail() { echo "FAILED: $*"; failed=1; }

# expect STATUS MESSAGE ARGUMENT...: the exit status, and a line that standard error has ("" = nothing at all)
expect() {
    status=$1 message=$2
    shift 2
    "$rbd_codegen" "$@" >out 2>err </dev/null
    found=$?
    [ $found -eq "$status" ] || fail "exit status $found, not $status: $*"
    if [ -n "$message" ]; then
        grep -qxF -- "rbd-codegen: $message" err || { fail "no line '$message': $*"; cat err; }
    elif [ -s err ]; then
        fail "something on standard error: $*"
        cat err
    fi
}

# ---- arguments ----

see="; see rbd-codegen --help"
iiwa=$root/models/iiwa.urdf
expect 0 "" --help
grep -q "^usage: rbd-codegen" out || fail "--help does not say how it is used"
grep -q "fd_cholesky" out || fail "--help does not say which functions there are"
expect 0 "" --version
grep -q "^rbd-codegen [0-9]" out || fail "--version does not say which"
expect 2 "no file given$see"
expect 2 "more than one file: 'b'$see" a b
expect 2 "unknown option '--x'$see" --x
expect 2 "--name: '1x' is not a C identifier$see" --name 1x a
expect 2 "'a-b' is not a C identifier: give a --name$see" a-b.urdf
expect 2 "--algorithm: there is no 'ik'$see" --algorithm id,ik a
expect 2 "--algorithm: 'id' stands twice$see" --algorithm id,id a
expect 2 "--algorithm: 'pose:left-foot' and 'pose:left_foot' have one name in C, 'pose_left_foot'$see" \
    --algorithm pose:left-foot,id,pose:left_foot a
expect 2 "--algorithm: its value is missing$see" --algorithm
expect 2 "--scalar: 'half' is neither double nor float$see" --scalar half a
expect 2 "--scalar: it stands twice$see" --scalar float --scalar=double a
expect 2 "--algorithm: it stands twice$see" --algorithm id --algorithm fd a
expect 2 "--lanes: '3' is none of 2, 4, 8, 16$see" --lanes 3 a
expect 2 "--limbs: '3' is none of 1, 2, 4$see" --limbs 3 a
expect 2 "--limbs: the lanes are those of --lanes already$see" --limbs 2 --lanes 2 a
expect 2 "--limbs: computes in another order than rbd.h, which --reproducible forbids$see" --limbs 2 --reproducible a
for option in "--lanes 2" "--limbs 2" --reproducible "--block 100" --example; do
    # shellcheck disable=SC2086 # words wanted
    expect 2 "--cuda: not with ${option%% *}$see" --cuda $option a
done
expect 2 "--cuda: 'long' means something else in C++: give a --name$see" --cuda --name long a
expect 2 "--cuda: 'std' means something else in C++: give a --name$see" --cuda std.urdf
expect 2 "--block: '9' is no number from 50 to 1000000$see" --block 9 a
expect 2 "unknown option '--bounded-angle'; did you mean '--bounded-angles'? See rbd-codegen --help" --bounded-angle a
expect 2 "unknown option '--floatin'; did you mean '--floating'? See rbd-codegen --help" --floatin a
expect 2 "--algorithm: there is no 'FD'; did you mean 'fd'? See rbd-codegen --help" --algorithm id,FD a
expect 2 "--algorithm: there is no 'gravty'; did you mean 'gravity_torque'? See rbd-codegen --help" --algorithm gravty a
expect 2 "--algorithm: there is no 'jacobain'; did you mean 'jacobian'? See rbd-codegen --help" --algorithm jacobain:x a
expect 2 "--algorithm: 'jacobian' is a link's: 'jacobian:LINK'$see" --algorithm jacobian a
expect 2 "--algorithm: 'id' takes no link$see" --algorithm id:foot a
expect 1 "--algorithm jacobian:foot: the robot has no link 'foot'" --algorithm jacobian:foot "$iiwa"
expect 1 "--algorithm pose:lbr_iiwa_link7: the robot has no link 'lbr_iiwa_link7'; did you mean 'lbr_iiwa_link_7'?" \
    --algorithm id,pose:lbr_iiwa_link7 "$iiwa"
expect 1 "--algorithm jacobian:ploe: the robot has no link 'ploe'; did you mean 'pole'?" \
    --algorithm jacobian:ploe "$root/models/cart_pole.urdf"
expect 1 "--algorithm pose:world: link 'world' is the world and no body" --algorithm pose:world "$iiwa"
expect 2 "--algorithm: 'id' stands twice$see" --algorithm id,rnea a
expect 2 "--algorithm: there is no ' long'; a link with a comma stands in quotes: '\"pose:pole, long\"'$see" \
    --algorithm "pose:pole, long" a
for list in '"pose:a,b' 'id,"pose:a,b"x' '"'; do
    expect 2 "--algorithm: a quote is not closed, or something follows it: $list$see" --algorithm "$list" a
done
expect 1 "--algorithm pose:po\"le, long: the robot has no link 'po\"le, long'" \
    --algorithm 'id,"pose:po""le, long",mm' "$root/models/cart_pole.urdf"
expect 2 "--algorithm: 'impact' needs --constraints FILE$see" --algorithm id,impact a
expect 2 "--constraints: no algorithm of the list takes them$see" --constraints feet.csv a
expect 2 "--passive: 'constrained_id' is not in the list$see" --passive x --algorithm impact --constraints feet.csv a
expect 2 "--stances: needs --constraints FILE$see" --stances gait.csv a
expect 2 "--stances: no algorithm of the list takes them$see" --stances gait.csv --algorithm delta --constraints feet.csv a
expect 2 "--stances: not with --lanes$see" --lanes 2 --stances gait.csv --algorithm impact --constraints feet.csv a
expect 1 "nowhere.csv: No such file or directory" --algorithm impact --constraints nowhere.csv "$iiwa"
printf 'body1,x1,axes\nlf_lowerleg,0.33,000111\nlf_lowerleg,0.2,000111\n' >twice.csv
printf 'body1,axes\nright_rod,000101\nleft_rod,000111\n' >sideways.csv
hyq=$root/models/hyq.urdf five_bar=$root/models/five_bar.urdf
expect 1 "--passive: the robot has no joint 'left_elbo' that moves; did you mean 'left_elbow'?" --passive left_elbo \
    --algorithm constrained_id --constraints "$root/models/five_bar_loop.csv" "$five_bar"
expect 1 "constrained: twice.csv: the 6 rows depend on each other in every state tried, their rank is 5: hold fewer axes, or call rbd.h" \
    --floating --algorithm constrained --constraints twice.csv "$hyq"
expect 1 "impact: row 3 of the constraints is 0 in every state: hold fewer axes" --algorithm impact --constraints sideways.csv "$five_bar"
inertia() { echo "<inertial><origin xyz='0.1 0.2 0.3'/><mass value='1'/><inertia ixx='$1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>"; }
echo "<robot name='rod'><link name='a'>$(inertia 1)</link><link name='b'>$(inertia 0)</link>
<joint name='j' type='floating'><parent link='a'/><child link='b'/></joint></robot>" >rod.urdf
expect 1 "minv: the mass matrix is singular at the joint of link 'b'" --floating --algorithm minv rod.urdf
expect 1 "twice.csv: row 2: column 'body1': the robot has no link 'lf_lowerleg'" --algorithm impact --constraints twice.csv "$iiwa"
printf 'body1,axes,kp\nlbr_iiwa_link_7,111000,9\n' >turns.csv
expect 1 "constrained: --reproducible: not with kp of one or three angular axes" --reproducible --algorithm constrained --constraints turns.csv "$iiwa"
expect 1 "constrained_id: --reproducible: not with constrained_id" --reproducible --algorithm constrained_id --constraints turns.csv "$iiwa"
expect 1 "fd: the mass matrix is singular at the joint of link 'world'" --floating --algorithm fd "$iiwa"
expect 1 "--output: there is no folder 'nowhere/at/all'" --output nowhere/at/all "$iiwa"
expect 1 "--output: there is no folder '/dev/null'" --output /dev/null "$iiwa"
mkdir -p there/iiwa_code.h
expect 1 "cannot write there/iiwa_code.h: Is a directory" --output there --algorithm gravity_torque "$iiwa"
mkdir -p there/half_code.c there/late_example.c
expect 1 "cannot write there/half_code.c: Is a directory" --output there --name half "$iiwa"
expect 1 "cannot write there/late_example.c: Is a directory" --output there --name late --example "$iiwa"
[ -z "$(find . -type f -name '*_*.[ch]')" ] || fail "files in spite of an error"
printf 'body1,axes\n' >empty.csv
expect 1 "empty.csv: no constraint: the table has a header alone" --algorithm impact --constraints empty.csv "$iiwa"

# ---- self-tests ----

# selftest NAME ARGUMENT...: the files, without warnings, give 0; with one result changed they do not
selftest() {
    name=$1 upper=$(echo "$1" | tr a-z A-Z)
    shift
    expect 0 "" --name "$name" "$@"
    [ -s out ] && fail "something on standard output: $*"
    broken=-DBROKEN
    case ${RBD_ALL_TESTS-}$name in yes* | iiwa | loop | same) ;; *) broken= ;; esac
    for flags in "" $broken; do
        [ -n "$flags" ] && sed -i "/^static const scalar ${name}_[a-zA-Z0-9_]*_is/{n;s/{/{1 + /}" "${name}_code.c"
        ${CC:-cc} -std=c99 -O0 -Wall -Wextra -Wpedantic -Wconversion -Wno-psabi -Werror \
            "-D${upper}_SELFTEST_MAIN" -o test "${name}_code.c" -lm || fail "does not compile: $*"
        ./test >out
        found=$?
        [ -z "$flags" ] && [ $found -ne 0 ] && fail "self-test $found: $*"
        [ -n "$flags" ] && [ $found -eq 0 ] && fail "self-test with another result: $*"
        word=${flags:+WRONG}
        [ "$(grep -c "^${name}_[a-zA-Z0-9_]*: 3 states, largest error [^ ]*, [^ ]* allowed: ${word:-right}$" out)" -eq \
            "$(grep -c "^\(int\|void\) ${name}_" "${name}_code.h")" ] || { fail "the self-test does not say what it did: $*"; cat out; }
    done
}
all=id,bias,gravity_torque,mm,mm_packed,minv,fd,fd_cholesky,id_derivatives,fd_derivatives,coriolis,momentum_matrix,com_jacobian
selftest iiwa --algorithm $all,jacobian:lbr_iiwa_link_7,pose:lbr_iiwa_link_7 "$iiwa"
selftest arm --scalar float --bounded-angles --short-sums "$iiwa"
selftest bounded --bounded-angles --lanes 2 --algorithm id,minv,mm "$root/models/cart_pole.urdf"
[ "$(grep -c "^   Angles: below 1e6 rad in size. Else, and if one is NaN, " bounded_code.h)" -eq 3 ] ||
    fail "the header does not say the range of the angles"
grep -q "^   Angles: below 1e6 rad in size.*returns -1 - BOUNDED_NV.$" bounded_code.h || fail "nor what is returned"
grep -q "^   Pivots: M counts as singular where one is at most 7.1e-15 of " bounded_code.h || fail "nor how pivots are judged"
[ "$(grep -c "^   Not checked: " bounded_code.h)" -eq 3 ] || fail "nor what is not checked"
# the self-test sees an angle out of range that is taken, by a function with a status and by one without
for algorithm in id fd; do
    expect 0 "" --name taken --bounded-angles --algorithm $algorithm "$iiwa"
    sed -i 's/if (!are_inside(squares)) sines_beyond/if (0) sines_beyond/' taken_code.c
    ${CC:-cc} -O0 -DTAKEN_SELFTEST -DTAKEN_SELFTEST_MAIN -o test taken_code.c -lm || fail "taken_code.c does not compile"
    ./test >out && fail "the self-test of $algorithm does not see that angles are taken which are out of range"
    grep -q "^taken_$algorithm: .* WRONG: takes an angle out of range$" out || fail "nor does it say so"
done
# tcc; and the sines of libm where sums keep more digits
for compiler in tcc "gcc -mfpmath=387"; do
    [ "$(echo __FLT_EVAL_METHOD__ | $compiler -E -P - 2>/dev/null)" = 2 ] || [ "$compiler" = tcc ] || continue
    command -v "${compiler%% *}" >/dev/null || continue
    for bounded in "" --bounded-angles; do
        case ${RBD_ALL_TESTS-}$bounded$compiler in gcc*) continue ;; esac
        # shellcheck disable=SC2086 # no option is none
        expect 0 "" --name tiny $bounded --algorithm id,fd,minv,fd_derivatives "$iiwa"
        $compiler -DTINY_SELFTEST -DTINY_SELFTEST_MAIN -o test tiny_code.c -lm && ./test >out || { fail "$compiler: $bounded"; cat out; }
    done
    case ${RBD_ALL_TESTS-}$compiler in gcc*) continue ;; esac
    expect 0 "" --name rows --floating --algorithm fd_derivatives "$hyq" # sums of rows without vectors
    $compiler -DROWS_SELFTEST -DROWS_SELFTEST_MAIN -o test rows_code.c -lm && ./test >out || { fail "$compiler: rows"; cat out; }
done
# rows of more fours than a sum holds, and registers of this machine
{
    echo "<robot name='chain'><link name='0'>$(inertia 1)</link>"
    for k in $(seq 45); do
        echo "<link name='$k'>$(inertia 1)</link><joint name='j$k' type='continuous'><parent link='$((k - 1))'/><child link='$k'/>
<origin xyz='0.1 0 0'/><axis xyz='$((k % 2)) $((1 - k % 2)) 0'/></joint>"
    done
    echo "</robot>"
} >chain.urdf
scalars=float
[ -z "${RBD_ALL_TESTS-}" ] || scalars="float double"
for scalar in $scalars; do # not optimised, which takes no more of the stack than their arrays
    expect 0 "" --name chain --scalar $scalar --algorithm minv chain.urdf
    ${CC:-cc} -O0 -march=native -Wno-psabi -Wframe-larger-than=100000 -Werror -DCHAIN_SELFTEST -DCHAIN_SELFTEST_MAIN \
        -o test chain_code.c -lm && ./test >out || { fail "a chain of 45 joints, $scalar"; cat out; }
done
sed "s/mass value='1'/mass value='1e308'/" chain.urdf >heavy.urdf # inf - inf
expect 1 "mm: a constant is not a number: the robot's lengths or masses overflow" --algorithm mm heavy.urdf
# each link a thousand times as heavy as the one before: rounding goes far, and that is no error
{
    echo "<robot name='heavy'><link name='0'/>"
    mass=1
    for k in $(seq 7); do
        echo "<link name='$k'><inertial><origin xyz='0.05 0.02 0.03'/><mass value='$mass'/>
<inertia ixx='${mass}e-2' ixy='0' ixz='0' iyy='${mass}e-2' iyz='0' izz='${mass}e-2'/></inertial></link>
<joint name='j$k' type='continuous'><parent link='$((k - 1))'/><child link='$k'/>
<origin xyz='0.3 0 0'/><axis xyz='$((k % 2)) $((1 - k % 2)) 0'/></joint>"
        mass=${mass}000
    done
    echo "</robot>"
} >heavy.urdf
selftest heavy --algorithm minv,fd,fd_derivatives heavy.urdf
sed "s/000/0000/g" heavy.urdf >heavier.urdf
expect 1 "minv: this scalar has too few digits for the robot" --scalar float --algorithm minv heavier.urdf
expect 1 "id: this scalar has too few digits for the robot" --gravity 0,0,-1e30 --scalar float --algorithm id heavy.urdf
# lengths that are rounding: products of them are no float
noise=1e-25
{
    echo "<robot name='noise'>"
    for k in 0 1 2; do
        echo "<link name='$k'><inertial><origin xyz='$noise .1 $noise'/><mass value='1'/>
<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
    done
    for k in 1 2; do
        echo "<joint name='j$k' type='continuous'><parent link='$((k - 1))'/><child link='$k'/>
<origin xyz='.1 $noise $noise'/><axis xyz='$((k % 2)) 0 $((1 - k % 2))'/></joint>"
    done
    echo "</robot>"
} >noise.urdf
selftest noise --floating --scalar float --algorithm fd,momentum_matrix noise.urdf
# names that could be those of a part, and of a self-test
sed "s/\(link\|link name\)='1'/\1='45_1'/g" chain.urdf >parts.urdf
selftest test --block 50 --algorithm jacobian:45,jacobian:45_1 parts.urdf
sed 's/"pole"/"pole, \&quot;long\&quot;"/' "$root/models/cart_pole.urdf" >comma.urdf
selftest test --algorithm 'id,"jacobian:pole, ""long""",mm' comma.urdf
selftest hyq --floating --algorithm id,fd --block 300 "$hyq"
selftest pairs --scalar float --floating --limbs 4 --f-ext --algorithm id,minv "$root/models/atlas.urdf"
grep -q "^#define LIMBS 2" pairs_code.c || fail "the pairs of limbs are not computed at once"
selftest legs --floating --limbs 4 --algorithm id,mm_packed,fd --block 100 "$hyq"
grep -q "^#define LIMBS 4" legs_code.c || fail "the four legs are not computed at once"
grep -q "Of these [0-9]* are of 4 limbs" legs_code.h || fail "the header does not say what is done at once"
printf 'body1,x1,axes\nlf_lowerleg,0.33,000111\nrf_lowerleg,0.33,000111\nlh_lowerleg,0.33,000111\nrh_lowerleg,0.33,000111\n' >feet.csv
printf 'body1,x1,z1,axes\nl_foot,0.05,-0.08,111111\nr_foot,0.05,-0.08,111111\n' >flat.csv
if [ -n "${RBD_ALL_TESTS-}" ]; then
    selftest flat --floating --limbs 2 --algorithm impact,constrained --constraints flat.csv "$root/models/atlas.urdf"
else
    echo "SKIPPED but by ./run test --all: constraints by pairs of limbs"
fi
printf 'lf_lowerleg,rh_lowerleg\nrf_lowerleg,lf_lowerleg,lh_lowerleg,rh_lowerleg\nnone\n' >gait.csv
selftest gait --floating --limbs 4 --bounded-angles --algorithm constrained,impact,constrained_id,delta \
    --constraints feet.csv --stances gait.csv "$hyq"
grep -q "before it, or nearly: it returns 1 + GAIT_NV + this row" gait_code.h || fail "nor how rows are judged"
grep -q "^int gait_delta(const double q\[19\], double Delta\[144\]);" gait_code.h || fail "Delta is not that of all constraints"
grep -q "^int gait_impact(int stance, const double q" gait_code.h || fail "the stance is no argument"
printf 'lf_lowerleg\nlf_upperleg\n' >knee.csv
printf 'lf_lowerleg,lf_foot\n' >foot.csv
printf 'lf_lowerleg,none\n' >both.csv
for message in "nowhere.csv: No such file or directory" "knee.csv: row 2: link 'lf_upperleg' is body1 of no constraint" \
    "both.csv: row 1: 'none' stands alone in its row" \
    "foot.csv: row 1: $("$rbd_codegen" --floating --algorithm pose:lf_foot "$hyq" 2>&1 | sed 's/.*pose:lf_foot: //')"; do
    expect 1 "$message" --floating --algorithm impact --constraints feet.csv --stances "${message%%:*}" "$hyq"
done
selftest pin --scalar float --passive left_elbow --passive right_elbow --algorithm impact,constrained_id \
    --constraints "$root/models/five_bar_loop.csv" "$five_bar"
printf 'left_rod\nnone\n' >open.csv
selftest open --algorithm constrained_id --constraints "$root/models/five_bar_loop.csv" --stances open.csv "$five_bar"
selftest loop --scalar float --lanes 2 --algorithm fd,constrained,impact --constraints "$root/models/five_bar_loop.csv" "$five_bar"
selftest held --algorithm constrained --constraints turns.csv "$iiwa"
selftest none --limbs 2 --algorithm gravity_torque "$iiwa"
grep -q "LIMBS" none_code.c && fail "like limbs of an arm"
selftest cart --lanes 4 --f-ext --gravity-argument --algorithm $all "$root/models/cart_pole.urdf"
selftest named --algorithm rnea,crba,aba --output= "$root/models/cart_pole.urdf"
grep -q "^int named_fd(" named_code.h || fail "aba is not fd"
selftest tilted --gravity 1,2,-9 --algorithm gravity_torque "$root/models/cart_pole.urdf"

# contracts: whole, and the test of it sees what is missing
contracts=$root/tests/codegen/contracts.py
python3 "$contracts" iiwa_code.h arm_code.h bounded_code.h hyq_code.h pairs_code.h legs_code.h cart_code.h || fail "a contract"
for line in "   tau " "   Angles: " "   Not checked: " "   Operations: " "   Stack: " "   Pivots: " "       rbd-codegen "; do
    cp hyq_code.c less_code.c && sed "0,/^$line/{/^$line/s/.*/   ./}" hyq_code.h >less_code.h
    python3 "$contracts" less_code.h >out && fail "a contract without '$line' passes"
done

# an example: its command line compiles it, and it prints what the function gives
for options in "--algorithm gravity_torque" "--algorithm fd,id --lanes 2 --gravity-argument" "--floating --scalar float --algorithm fd"; do
    # shellcheck disable=SC2086 # words wanted
    expect 0 "" --name shown --example $options "$root/models/hyq.urdf"
    grep -q "^    shown_\|= shown_" shown_example.c || fail "the example calls nothing: $options"
    sed "s/^cc -O2 /${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wvla -Wundef -Wno-psabi -Werror /" out >line
    rm -f shown_example
    { sh ./line && ./shown_example >printed; } || fail "the example of $options"
    n=$(sed -n 's/.*i < \([0-9]*\).*/\1/p' shown_example.c)
    [ "$(grep -c '^[a-z]*\[[0-9]*\] = -\?[0-9]' printed)" -eq "$n" ] || { fail "the example does not print $n results: $options"; cat printed; }
done
grep -q '^a\[5\] = -9.81$' printed || { fail "the floating robot does not fall"; cat printed; }

# reproducible: to the bit, and refused where that cannot be; reproducible_code.c compares bits with rbd.h's
for options in "" "--scalar float --lanes 4" "--bounded-angles --lanes 2" "--scalar float --bounded-angles"; do
    case ${RBD_ALL_TESTS-}$options in yes* | *lanes*) ;; *) continue ;; esac
    # shellcheck disable=SC2086 # words wanted
    selftest same --reproducible $options --algorithm id,minv "$iiwa"
    [ "$(grep -c ' largest error 0.0e+00, 0.0e+00 allowed: ' out)" -eq 2 ] && fail "no result is changed: $options"
    sed -i 's/{1 + /{/' same_code.c
    ${CC:-cc} -O2 -w -march=native -DSAME_SELFTEST -DSAME_SELFTEST_MAIN -o test same_code.c -lm && ./test >out || fail "other bits: $options"
    [ "$(grep -c ' largest error 0.0e+00, 0.0e+00 allowed: right$' out)" -eq 2 ] || { fail "not to the bit: $options"; cat out; }
done
for option in -ffast-math -ffinite-math-only -mfpmath=387; do
    compiler=${CC:-cc}
    [ $option != -mfpmath=387 ] || compiler=gcc # clang has it not
    [ $option != -mfpmath=387 ] || [ "$(echo __FLT_EVAL_METHOD__ | $compiler $option -E -P - 2>/dev/null)" = 2 ] || continue
    $compiler $option -fsyntax-only same_code.c 2>out && fail "$option is taken"
    grep -q '#error' out || { fail "$option is not refused by name"; cat out; }
done

# the sines
for scalar in double float; do
    expect 0 "" --name sines --scalar $scalar --algorithm gravity_torque "$iiwa"
    ${CC:-cc} -O1 -I"$root" -I. -DRBD_REAL=$scalar -DCODE='"sines_code.c"' "$root/tests/codegen/sines.c" -o sines -lm &&
        ./sines || fail "the sines of $scalar are not those of rbd.h"
done

# what the files say that wrote them writes the same again
cp cart_code.h first.h && cp cart_code.c first.c
eval "set -- $(sed -n 's/^       rbd-codegen //p' cart_code.h)"
[ "$*" = "--name cart --lanes 4 --f-ext --gravity-argument --algorithm $all $root/models/cart_pole.urdf" ] || fail "the command: $*"
rm cart_code.?
expect 0 "" "$@"
cmp -s first.h cart_code.h || fail "another header the second time"
eval "set -- $(sed -n 's/^       rbd-codegen //p' cart_code.c)"
expect 0 "" "$@"
sed "s/{1 + /{/" first.c | cmp -s - cart_code.c || fail "another source the second time"

# --cuda: one file, whose command writes it again; bounded angles and short sums are its own
mkdir device
expect 0 "" --cuda --bounded-angles --short-sums --output device --algorithm id,fd "$iiwa"
[ "$(ls device)" = iiwa_code.cuh ] || fail "--cuda writes $(ls device)"
grep -q '^   -1 - NV if an angle is out of range. \*/$' device/iiwa_code.cuh || fail "--cuda does not say what angles are refused"
mv device/iiwa_code.cuh first.cuh
eval "set -- $(sed -n 's/^       rbd-codegen //p' first.cuh)"
expect 0 "" "$@"
cmp -s first.cuh device/iiwa_code.cuh || fail "--cuda: another file the second time"
expect 0 "" --cuda --output device --algorithm id,fd "$iiwa"
sed 's/ --bounded-angles --short-sums//' first.cuh | cmp -s - device/iiwa_code.cuh || fail "--cuda: another file without its own options"

# C++ takes the header, and says of the source that it is C
printf '#include "iiwa_code.h"\nint main() { double q[IIWA_NQ] = {}, tau[IIWA_NV]; iiwa_gravity_torque(q, tau); return tau[0] > 1 || iiwa_selftest(); }\n' >use.cpp
sed "s/{1 + /{/" iiwa_code.c >right_code.c
${CC:-cc} -DIIWA_SELFTEST -Wmissing-prototypes -Werror -c right_code.c -o iiwa.o && ${CXX:-c++} use.cpp iiwa.o -lm -o use && ./use || fail "not from C++"
${CXX:-c++} -x c++ -c iiwa_code.c -o iiwa.o 2>&1 | grep -q "this file is C99: compile it as C" || fail "C++ does not say that the source is C"

[ -n "${RBD_ALL_TESTS-}" ] || echo "SKIPPED but by ./run test --all: a changed result in other self-tests, a chain in double, reproducible code without lanes, some by x87"
exit $failed
