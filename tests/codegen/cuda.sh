#!/bin/sh
# Generated code for CUDA, on machines without a GPU.
# usage: cuda.sh ROOT RBD_CODEGEN on_host|by_clang|by_nvcc [--accept]
#   on_host    kernels as loops, in all layouts, against the same functions in C: to the bit where nothing is fused
#   by_clang   to PTX, with neither CUDA nor any header: no call, no local memory
#              both with RBD_ALL_TESTS=yes of more robots
#   by_nvcc    registers, stack and spills of each kernel are those of cuda_nvcc.csv, by the nvcc that made it; --accept: make it
set -u
root=$(realpath "$1") rbd_codegen=$(realpath "$2") how=$3
here=$root/tests/codegen models=$root/models
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
failed=0

fail() { echo "FAILED: $*"; failed=1; }

# ---- robots ----

plain=id,bias,gravity_torque,mm,mm_packed,minv,fd,fd_cholesky,id_derivatives,fd_derivatives,gravity_torque_derivatives
plain=$plain,coriolis,momentum_matrix,com_jacobian
printf 'body1,axes,kp\nlbr_iiwa_link_7,111000,9\n' >hand.csv
printf 'body1,x1,axes\nlf_lowerleg,0.33,000111\nrf_lowerleg,0.33,000111\nlh_lowerleg,0.33,000111\nrh_lowerleg,0.33,000111\n' >feet.csv
printf 'lf_lowerleg,rh_lowerleg\nrf_lowerleg,lf_lowerleg,lh_lowerleg,rh_lowerleg\nnone\n' >gait.csv

# 200 links, each on the one ten before it
{
    echo "<robot name='tree'>"
    for k in $(seq 0 200); do
        echo "<link name='$k'><inertial><origin xyz='0.1 0.02 0.03'/><mass value='1'/>
<inertia ixx='0.01' ixy='0' ixz='0' iyy='0.02' iyz='0' izz='0.03'/></inertial></link>"
        [ "$k" -gt 0 ] || continue
        echo "<joint name='j$k' type='continuous'><parent link='$((k > 10 ? k - 10 : 0))'/><child link='$k'/>
<origin xyz='0.1 0.05 0' rpy='0 $((k % 2)) 0'/><axis xyz='$((k % 2)) $((1 - k % 2)) 0'/></joint>"
    done
    echo "</robot>"
} >tree.urdf

# write ROBOT ARGUMENT...: ROBOT_code.cuh, and the same in C
write() {
    robot=$1
    shift
    "$rbd_codegen" --cuda --name "$robot" "$@" && "$rbd_codegen" --short-sums --bounded-angles --name "$robot" "$@" ||
        { fail "not written: $*"; exit 1; }
}

# ---- on a host ----

# right ROBOT...: several in one file
right() {
    sources=$(printf '%s_code.c ' "$@") headers=$(printf '%s_code.h ' "$@")
    # shellcheck disable=SC2086 # words wanted
    python3 "$here/cuda_main.py" $headers >main.cpp || exit 1
    objects=
    for source in $sources; do
        ${CC:-cc} -std=c99 -O0 -w -c "$source" || exit 1
        objects="$objects ${source%.c}.o"
    done
    # shellcheck disable=SC2086 # words wanted
    ${CXX:-c++} -std=c++11 -O0 -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wundef -Werror -I"$here" \
        main.cpp $objects -lm -o check || { fail "$*: does not compile"; return; }
    ./check >out || { fail "$*"; head -20 out; }
}

on_host() {
    write iiwa --f-ext --gravity-argument --constraints hand.csv \
        --algorithm $plain,constrained,impact,delta,constrained_id,jacobian:lbr_iiwa_link_7,pose:lbr_iiwa_link_7 "$models/iiwa.urdf"
    write arm --scalar float --algorithm $plain "$models/iiwa.urdf"
    write hyq --floating --constraints feet.csv --stances gait.csv --algorithm id,fd,constrained,impact,constrained_id \
        "$models/hyq.urdf"
    right iiwa arm
    if [ -n "${RBD_ALL_TESTS-}" ]; then
        write atlas --floating --scalar float --algorithm id,mm_packed,fd "$models/atlas.urdf"
        write tree --scalar float --algorithm id tree.urdf
        right hyq atlas
        right tree
    else
        right hyq
        echo "SKIPPED but by ./run test --all: Atlas and a tree of 200 links"
    fi

    # it sees a wrong statement, and a wrong status
    write few --scalar float --algorithm fd "$models/iiwa.urdf"
    python3 "$here/cuda_main.py" few_code.h >main.cpp
    ${CC:-cc} -std=c99 -O0 -w -c few_code.c || exit 1
    for wrong in '/^RBD_HD int fd(/,/^}/s/ t9 = / t9 = 0.001f + /' '/^RBD_HD int fd(/,/^}/s/return status/return status + 1/'; do
        sed -i.right "$wrong" few_code.cuh
        ${CXX:-c++} -std=c++11 -O0 -I"$here" main.cpp few_code.o -lm -o check || fail "does not compile: $wrong"
        ./check >out && fail "nothing is wrong: $wrong"
        grep -q "^few_fd, layout 2: state 0 is wrong" out || fail "it does not say what is wrong: $wrong"
        mv few_code.cuh.right few_code.cuh
    done
    contracts iiwa && contracts hyq
    for option in -ffast-math -ffinite-math-only -D__USE_FAST_MATH__; do
        ${CXX:-c++} -std=c++11 $option -x c++ -fsyntax-only arm_code.cuh 2>out && fail "$option is taken"
        grep -q '#error' out || fail "$option is not refused by name"
    done
}

# contracts ROBOT: they are those of C, without the stack
contracts() {
    for file in "$1_code.h" "$1_code.cuh"; do
        grep '^   \(Angles\|Pivots\|Rows\|Digits\|Not checked\|Operations\): ' "$file" |
            sed "s/$(echo "$1" | tr a-z A-Z)_NV/NV/; s/ \*\/$//" >"$file.contracts"
    done
    grep -q '^   Pivots: ' "$1_code.h.contracts" || fail "$1: no contract"
    diff "$1_code.h.contracts" "$1_code.cuh.contracts" || fail "$1: contracts are not those of C"
}

# ---- device code ----

# kernels ROBOT LAYOUTS: ROBOT.cu, all of them in these layouts
kernels() { python3 "$here/cuda_main.py" --instances "$2" "$1_code.h" >"$1.cu" || exit 1; }

device_robots() {
    write iiwa --scalar float --constraints hand.csv --algorithm $plain,impact,jacobian:lbr_iiwa_link_7,pose:lbr_iiwa_link_7 \
        "$models/iiwa.urdf"
    write arm --algorithm id,mm,fd,minv,id_derivatives "$models/iiwa.urdf"
    write hyq --floating --scalar float --constraints feet.csv --algorithm id,mm,fd,minv,constrained "$models/hyq.urdf"
    write atlas --floating --scalar float --algorithm id,mm "$models/atlas.urdf"
    kernels iiwa rows,blocks
    kernels arm rows,blocks
    kernels hyq rows,blocks
    kernels atlas rows,blocks
}

# ptx ROBOT GPU
ptx() {
    clang++-19 -x cuda --cuda-device-only -nocudainc -nocudalib -nostdinc --cuda-gpu-arch="$2" -std=c++11 -O2 -Wall -Wextra \
        -Wno-unknown-cuda-version -Werror -include "$here/no_cuda.h" -S "$1.cu" -o "$1.ptx" || { fail "clang: $1 for $2"; return; }
    [ "$(grep -c '^\.visible \.entry' "$1.ptx")" -eq "$(grep -c '^template\|^__global__' "$1.cu")" ] || fail "$1 for $2: not all kernels"
    ! grep -n '\.local\|[^_]call' "$1.ptx" | head -5 | grep . || fail "$1 for $2: local memory, or calls"
}

by_clang() {
    case $(clang++-19 --print-targets 2>&1) in
    *nvptx64*) ;;
    *) echo "skipped: there is no clang++-19 for NVIDIA's GPUs"; exit 77 ;;
    esac
    device_robots
    if [ -n "${RBD_ALL_TESTS-}" ]; then
        ptx iiwa sm_87
        ptx iiwa sm_90
        ptx atlas sm_90
    else
        echo "SKIPPED but by ./run test --all: the iiwa with all its functions, for two GPUs, and Atlas"
    fi
    ptx arm sm_90
    ptx hyq sm_87
    awk '$0 == "```cpp" { inside = 1; next } inside && /^```/ { exit } inside' "$root/docs/generated_code.md" >guide.cu
    ptx guide sm_90
    # it sees an array that is no registers, and a call
    sed -i 's/^RBD_HD void mm(.*/&\n    volatile real memory[2] = {q[0], 0};\n    (void)memory[1];/' arm_code.cuh
    (ptx arm sm_90) | grep -q 'FAILED: arm for sm_90: local memory' || fail "nor does it see local memory"
}

# table ROBOT GPU: lines of cuda_nvcc.csv
table() {
    "$nvcc" -std=c++11 -O3 -arch="$2" -cubin -Xptxas -v -Werror all-warnings "$1.cu" -o /dev/null 2>log || { fail "nvcc: $1 for $2"; cat log; }
    python3 "$here/cuda_table.py" "$1" "$2" <log
}

by_nvcc() {
    nvcc=$(command -v nvcc || echo /usr/local/cuda/bin/nvcc)
    [ -x "$nvcc" ] || { echo "skipped: there is no nvcc"; exit 77; }
    version=$("$nvcc" --version | sed -n 's/.* V\([0-9.]*\)$/\1/p') kept=$here/cuda_nvcc.csv
    [ "${1-}" = --accept ] || grep -q "^# nvcc $version:" "$kept" || { echo "skipped: the table is of another nvcc than $version"; exit 77; }
    device_robots
    "$nvcc" -std=c++11 -arch=sm_90 -Xcompiler -Wall,-Wextra,-Wconversion,-Wshadow,-Werror -c arm.cu || fail "nvcc: warnings for the host"
    {
        echo "# nvcc $version: tests/codegen/cuda.sh ROOT RBD_CODEGEN by_nvcc --accept writes this"
        echo "robot,gpu,kernel,layout,registers,stack bytes,bytes spilled"
        for robot in iiwa arm hyq atlas; do table $robot sm_90; done
        table iiwa sm_87
    } >found.csv
    if [ "${1-}" = --accept ]; then cp found.csv "$kept"; else diff "$kept" found.csv || fail "other registers than in $kept"; fi
}

shift 3
"$how" "$@"
exit $failed
