#!/bin/sh
# Code of a GPU, without one. On the host, compiled as for a GPU, kernels are loops: their results are those of the
# usual calls, and robots fall on their feet. clang makes PTX of them, without CUDA's headers and libraries, and code
# for AMD; nvcc, where it is, compiles one.
# usage: test.sh DIRECTORY_OF_RBD_H     CC, CXX: compilers; NVCC: nvcc; with RBD_ALL_TESTS=yes also PTX for sm_90 at -O2,
# and code for AMD
# test.sh DIRECTORY_OF_RBD_H all: nvcc compiles everything, which takes a minute
set -u

root=${1:?usage: test.sh DIRECTORY_OF_RBD_H [all]}
which=${2:-inverse_dynamics}
kernels=$root/tests/device/kernels.cu
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
failures=0

failed() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# loops: the host, as for a GPU, against the host as usual
loops() {
    # shellcheck disable=SC2086 # words wanted
    ${CC:-cc} -std=c99 -O0 -Dalways_inline=unused -I"$root" -c "$root/tests/device/usual.c" -o "$scratch/usual.o" &&
        ${CXX:-c++} -x c++ -std=c++11 -O0 -Dalways_inline=unused -Wall -Wno-ignored-attributes -I"$root" "$kernels" -x none "$scratch/usual.o" \
            -o "$scratch/loops" && "$scratch/loops"
}

# what falling prints, without times and rounding
falling() {
    "$scratch/falling" 7 700 4 2 >"$scratch/printed" || return 1
    sed 's/: [0-9.e-]* s, .*//; s/; q differs.*//' "$scratch/printed"
}

# falls: the example without a GPU, which prints what its page shows
falls() {
    # shellcheck disable=SC2086 # words wanted
    ${CXX:-c++} -x c++ -std=c++11 -O0 -Wall -Wextra -Dalways_inline=unused -I"$root" "$root/examples/gpu/falling.cu" \
        -o "$scratch/falling" && falling >"$scratch/fell" && sh "$root/examples/check.sh" "$root/examples/README.md" gpu_falling cat "$scratch/fell"
}

# ptx ARCHITECTURE FLAGS: all kernels are there, and nothing that they call is missing. The code model stops a pass of
# clang 19 whose tables its own back end cannot write.
ptx() {
    # shellcheck disable=SC2086 # words wanted
    clang++-19 -x cuda --cuda-device-only -nocudainc -nocudalib --cuda-gpu-arch="$1" $2 -mcmodel=medium -std=c++11 \
        -Wall -Werror -Wno-unknown-cuda-version -S -I"$root" "$kernels" -o "$scratch/$1.ptx" || return 1
    [ "$(grep -c '\.visible \.entry' "$scratch/$1.ptx")" -eq 11 ] || { echo "not eleven kernels"; return 1; }
    ! grep '\.extern' "$scratch/$1.ptx"
}

# example: the manual's kernel, with the words of CUDA that it uses
example() {
    {
        sed -n '/^#if defined __NVCC__/,/^#ifdef __HIP__/p' "$kernels" | sed '$d'
        echo '#define blockIdx (index{__nvvm_read_ptx_sreg_ctaid_x()})
struct index { int x; };
#define blockDim (index{__nvvm_read_ptx_sreg_ntid_x()})
#define threadIdx (index{__nvvm_read_ptx_sreg_tid_x()})
#endif'
        sed -n '/^   \[GPU\]/,/^       }/p' "$root/rbd.h" | sed 1,2d
    } >"$scratch/example.cu"
    clang++-19 -x cuda --cuda-device-only -nocudainc -nocudalib --cuda-gpu-arch=sm_87 -O1 -mcmodel=medium -std=c++11 \
        -Werror -Wno-unknown-cuda-version -S -I"$root" "$scratch/example.cu" -o "$scratch/example.ptx" &&
        grep -q 'entry.*torques' "$scratch/example.ptx"
}

amd() {
    clang++-19 -x hip --cuda-device-only -nogpuinc -nogpulib --offload-arch=gfx90a -O1 -std=c++11 -Wall -Werror \
        -Wno-unused-function -S -DONLY=inverse_dynamics -I"$root" "$kernels" -o "$scratch/amd.s" &&
        grep -q 'amdhsa_kernel.*inverse_dynamics_kernel' "$scratch/amd.s"
}

# cubin NVCC KERNEL: registers and memory of each kernel are printed
cubin() {
    only=-DONLY=$2
    [ "$2" = all ] && only=
    # shellcheck disable=SC2086 # words wanted
    "$1" -std=c++14 -arch=sm_90 -Xptxas -v $only -I"$root" -cubin "$kernels" -o "$scratch/kernels.cubin" \
        >"$scratch/messages" 2>&1 || { cat "$scratch/messages"; return 1; }
    grep -E 'Compiling entry|Used' "$scratch/messages"
    ! grep -i warning "$scratch/messages"
}

loops || failed "results of the kernels as loops"
falls || failed "robots that fall"

if command -v clang++-19 >/dev/null; then
    ptx sm_87 '-O0 -Dalways_inline=unused' || failed "PTX for sm_87"
    if [ -n "${RBD_ALL_TESTS-}" ]; then
        ptx sm_90 -O2 || failed "PTX for sm_90"
        amd || failed "code for AMD"
    else
        echo "SKIPPED but by ./run test --all: PTX for sm_90 at -O2, code for AMD"
    fi
    example || failed "the manual's example"
else
    echo "clang++-19 is not installed: no PTX"
fi

nvcc=${NVCC:-$(command -v nvcc || echo /usr/local/cuda/bin/nvcc)}
if [ -x "$nvcc" ]; then
    cubin "$nvcc" "$which" || failed "nvcc"
else
    echo "nvcc is not installed"
fi

echo "$failures failed"
[ "$failures" -eq 0 ]
