#!/bin/sh
# RBD_REPRODUCIBLE: reproducible.c prints the hashes of reproducible.txt, whatever compiles and runs it, and its code has
# no FMA. So does reproducible_code.c with the code of rbd-codegen --reproducible, which RBD_CODEGEN names; the hashes of
# reproducible_code.txt are those of the library's calls. On another machine's processor by qemu-user, on
# microcontrollers by QEMU. Says what it had to leave out.
# usage: reproducible.sh [--all | --write] DIRECTORY_OF_RBD_H [REGEX]
#     light: gcc in double, clang in float, and what is refused, a quarter of a minute of a processor; with
#     RBD_ALL_TESTS=yes some of each kind, tcc, wasm and a microcontroller too; --all in an hour and a half on two cores; --write
#     keeps the hashes of gcc -O1 as those of reproducible.txt, and reproducible_code.txt. REGEX: only those whose command
#     line it matches.
set -eu

usage='usage: reproducible.sh [--all | --write] DIRECTORY_OF_RBD_H [REGEX]'
how=light
all_tests=${RBD_ALL_TESTS-} # of light
case ${1-} in --*) how=${1#--} && shift ;; esac
root=${1:?$usage} only=${2-}
expected=$root/tests/reproducible.txt expected_code=$root/tests/reproducible_code.txt
codegen=${RBD_CODEGEN-}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0 checks=0 missing=
[ -n "$codegen" ] || missing=" rbd-codegen"
scalars="double float"
robots=iiwa
fused='\<(vfn?m(add|sub)|fn?m(add|sub)|fml[as]|vfn?m[as]\.|ma[de]b|ms[de]b|wfn?m[as][ds]b)'
quickly=-Dalways_inline=unused # compiled in a third of the time

# object OUTPUT SOURCE COMPILER OPTION...: by way of assembly, in which no FMA may be
object() {
    object=$1 source=$2 compiler=$3
    shift 3
    set -- -std="${dialect:-c99}" -w -I"$root" -I"$root/tests" "$@"
    case "$compiler $*" in # no FMA there, and clang's assembler refuses some of the WebAssembly that clang writes
    tcc* | *wasm32*)
        $compiler "$@" -c "$source" -o "$object"
        return
        ;;
    esac
    $compiler "$@" -S "$source" -o "$scratch/code.s" || return 1
    if grep -E "$fused" "$scratch/code.s" >"$scratch/fused"; then
        echo "FAILED: FMA in the code:" && sed -n '1,3p' "$scratch/fused"
        return 1
    fi
    # shellcheck disable=SC2086 # words wanted
    $compiler ${machine-} -c "$scratch/code.s" -o "$object"
}

# compile OUTPUT SCALAR COMPILER OPTION...: the program
compile() {
    output=$1 real=$2 program=$3
    shift 2
    # shellcheck disable=SC2086 # words wanted
    object "$scratch/program.o" "$root/tests/reproducible.c" "$@" -DRBD_REAL="$real" &&
        $program ${machine-} "$scratch/program.o" -o "$output" ${link:--lm}
}

# generate ROBOT SCALAR: into $scratch/ROBOT-SCALAR, once; sets robot_options of reproducible_code.c
generate() {
    tip=lbr_iiwa_link_7 floating=--floating folder=$scratch/$1-$2
    case $1 in iiwa) floating= ;; hyq) tip=lf_lowerleg ;; atlas) tip=l_foot ;; esac
    robot_options="-I$folder -DREAL=$2 -DROBOT=$1 -DLINK=$tip"
    [ ! -e "$folder/code_code.c" ] || return 0
    mkdir -p "$folder"
    "$codegen" --reproducible --scalar "$2" --name code $floating --f-ext --output "$folder" --algorithm \
        "$algorithms,jacobian:$tip,pose:$tip" "$root/models/$1.urdf"
}
algorithms=id,bias,gravity_torque,mm,mm_packed,minv,fd,fd_cholesky,id_derivatives,fd_derivatives
algorithms=$algorithms,gravity_torque_derivatives,coriolis,momentum_matrix,com_jacobian

# compile_code OUTPUT ROBOT SCALAR COMPILER OPTION...: the program of generated code
compile_code() {
    output=$1 robot=$2 real=$3 program=$4
    shift 3
    generate "$robot" "$real" || return 1
    # shellcheck disable=SC2086 # words wanted
    object "$scratch/code.o" "$scratch/$robot-$real/code_code.c" "$@" &&
        object "$scratch/program.o" "$root/tests/reproducible_code.c" "$@" $robot_options &&
        $program ${machine-} "$scratch/program.o" "$scratch/code.o" -o "$output" ${link:--lm}
}

# wanted NAME: whether it is one of those asked for; counts it
wanted() {
    printf '%s\n' "$1" | grep -Eq -e "$only" || return 1
    checks=$((checks + 1))
}

# build COMPILER OPTION...: with each scalar; `emulator` runs it, `machine` and `link` are options for linking
build() {
    for real in $scalars; do
        name="$* $real"
        wanted "$name" || continue
        # shellcheck disable=SC2086 # words wanted
        if compile "$scratch/program" "$real" "$@" && ${emulator-} "$scratch/program" >"$scratch/found" &&
            grep "^$real " "$expected" | cmp -s - "$scratch/found"; then
            echo "ok: $name"
            continue
        fi
        failures=$((failures + 1))
        echo "FAILED: $name"
        grep "^$real " "$expected" | diff - "$scratch/found" || true
        # The first call that differs.
        (emulator='' machine='' link=-lm && compile "$scratch/right" "$real" gcc -O1 -DEACH_CALL && "$scratch/right") >"$scratch/calls"
        # shellcheck disable=SC2086 # words wanted
        compile "$scratch/program" "$real" "$@" -DEACH_CALL && ${emulator-} "$scratch/program" |
            diff "$scratch/calls" - | sed -n '1,4p'
    done
    build_code "$@"
}

# build_code COMPILER OPTION...: the same of generated code of `robots`
build_code() {
    [ -n "$codegen" ] || return 0
    for real in $scalars; do
        for robot in $robots; do
            name="$* $real, code of $robot"
            wanted "$name" || continue
            : >"$scratch/found"
            # shellcheck disable=SC2086 # words wanted
            if compile_code "$scratch/program" "$robot" "$real" "$@" && ${emulator-} "$scratch/program" >"$scratch/found" &&
                grep "^$real $robot " "$expected_code" | cmp -s - "$scratch/found"; then
                echo "ok: $name"
                continue
            fi
            failures=$((failures + 1))
            echo "FAILED: $name"
            grep "^$real $robot " "$expected_code" | diff - "$scratch/found" || true
        done
    done
}

# with COMPILER [EMULATOR]: whether they are there; else they are noted as missing
with() {
    for program; do
        command -v "$program" >/dev/null 2>&1 || { missing="$missing $program" && return 1; }
    done
}

if [ "$how" = write ]; then
    for real in $scalars; do
        compile "$scratch/program" "$real" gcc -O1 && "$scratch/program"
    done >"$scratch/found"
    cp "$scratch/found" "$expected"
    [ -n "$codegen" ] || { echo "RBD_CODEGEN names no rbd-codegen: $expected_code is as it was" && exit 1; }
    for real in $scalars; do
        for robot in iiwa hyq atlas; do
            generate $robot "$real"
            # shellcheck disable=SC2086 # words wanted
            object "$scratch/program.o" "$root/tests/reproducible_code.c" gcc -O1 $quickly $robot_options -DBY_LIBRARY \
                -DMODEL_FILE="\"models/${robot}_model.h\"" && gcc "$scratch/program.o" -o "$scratch/program" -lm && "$scratch/program"
        done
    done >"$scratch/found"
    cp "$scratch/found" "$expected_code"
    exit
fi

# runs UNIT...: whether this processor has these SIMD units, as /proc/cpuinfo names them
runs() {
    for unit; do grep -qw "$unit" /proc/cpuinfo 2>/dev/null || return 1; done
}

# ---- this machine's compilers ----

if [ "$how" = light ]; then
    scalars=double
    ! with gcc || build gcc -Og -march=native -ffp-contract=fast $quickly
    scalars=float
    # Products and sums in one expression are what clang fuses in spite of us, before it optimises.
    ! with clang-19 || build clang-19 -O0 -march=native -ffp-contract=on $quickly
    scalars="double float"
else
    for compiler in gcc clang-16 clang-19; do
        with $compiler || continue
        contract=-ffp-contract=on # clang contracts in spite of us with `fast`: see below
        [ $compiler != gcc ] || contract=-ffp-contract=fast
        for level in 0 g 1 2 3 s; do
            build $compiler -O$level
            build $compiler -O$level -march=native $contract
        done
        robots="hyq atlas" # whose code takes a minute to compile
        build_code $compiler -O1
        build_code $compiler -O1 -march=native $contract
        robots=iiwa
        if [ "$(uname -m)" = x86_64 ]; then
            build $compiler -O2 -mno-sse3
            build $compiler -O2 -U__SSE2__ # scalars alone
            ! runs avx2 fma || build $compiler -O2 -mavx2 -mfma $contract
            ! runs avx512f avx512dq || build $compiler -O3 -mavx512f -mavx512dq -mfma $contract
        fi
    done
fi
# tcc 0.9.27 overwrites an argument that is a structure of three floats while it computes the next one.
if [ "$how$all_tests" != light ] && [ "$(uname -m)" = x86_64 ] && with tcc; then scalars=double build tcc; fi

# ---- RBD_FEATURES: what a robot needs gives the same bits as the whole library ----

# features ROBOT COMPILER OPTION...
features() {
    robot=$1 all=$(echo "$1" | tr a-z A-Z)_FEATURES
    shift
    for real in $scalars; do
        name="$* $real, features of $robot"
        wanted "$name" || continue
        : >"$scratch/found"
        if compile "$scratch/right" "$real" "$@" -DEACH_CALL -DALONE="$robot" -DMODEL_FILE="\"models/${robot}_model.h\"" &&
            "$scratch/right" >"$scratch/calls" && [ -s "$scratch/calls" ] &&
            compile "$scratch/program" "$real" "$@" -DEACH_CALL -DALONE="$robot" -DMODEL_FILE="\"models/${robot}_model.h\"" \
                -DRBD_FEATURES="$all" &&
            "$scratch/program" >"$scratch/found" && cmp -s "$scratch/calls" "$scratch/found"; then
            echo "ok: $name"
        else
            failures=$((failures + 1))
            echo "FAILED: $name"
            diff "$scratch/calls" "$scratch/found" | sed -n '1,4p'
        fi
    done
}
if with gcc; then
    [ "$how" = all ] || scalars=float
    [ "$how$all_tests" = light ] || features iiwa gcc -O1 -march=native $quickly
    scalars="double float"
    [ "$how" = light ] || for robot in hyq atlas; do features $robot gcc -O1 -march=native $quickly; done
fi

# ---- what is refused ----

cat >"$scratch/rod.c" <<'END'
#define RBD_REPRODUCIBLE
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"

int main(void) {
    static const rbd_body rod[1] = {
        {.parent = -1, .type = RBD_REVOLUTE, .axis = {0, 1, 0}, .mass = 1, .com = {0, 0, -1}}};
    static unsigned char model_memory[RBD_MODEL_SIZE(1)], work_memory[RBD_WORK_SIZE(1, 1)];
    const rbd_model *m;
    rbd_work *w;
    if (rbd_model_build(rod, 1, model_memory, sizeof model_memory, &m, NULL)) return 1;
#ifdef __SSE2__ /* rounding down, up and to zero; results flushed to zero, and arguments: each is refused */
    static const unsigned mode[5] = {0x2000, 0x4000, 0x6000, 0x8000, 0x40};
    const unsigned usual = __builtin_ia32_stmxcsr();
    for (int i = 0; i < 5; i++) {
        __builtin_ia32_ldmxcsr(usual | mode[i]);
        const rbd_status status = rbd_work_init(m, work_memory, sizeof work_memory, &w);
        __builtin_ia32_ldmxcsr(usual);
        if (status != RBD_ERR_ARITHMETIC) return 2 + i;
    }
#endif
    return rbd_work_init(m, work_memory, sizeof work_memory, &w) == EXPECTED ? 0 : 1;
}
END

# gives STATUS COMPILER OPTION...: so does rbd_work_init, under `emulator`
gives() {
    status=$1
    shift
    name="$* $status"
    wanted "$name" || return 0
    # shellcheck disable=SC2086 # words wanted
    if "$@" -std=c99 -w $quickly -DEXPECTED="$status" -I"$root" "$scratch/rod.c" -o "$scratch/program" ${link:--lm} &&
        ${emulator-} "$scratch/program"; then
        echo "ok: $name"
    else
        failures=$((failures + 1)) && echo "FAILED: $name"
    fi
}
if [ "$(uname -m)" = x86_64 ]; then
    compiler=gcc
    [ "$how" != light ] || ! with clang-19 || compiler=clang-19 # which leaves out what is not called
    ! with $compiler || gives RBD_OK $compiler -O0 # but not in other modes of the processor
    # A square root that rounds twice, as MinGW's: for floats that makes no difference.
    ! with $compiler || gives RBD_ERR_ARITHMETIC $compiler -O0 '-DRBD_SQRT(x)=(double)sqrtl((long double)(x))'
    ! with $compiler || gives RBD_OK $compiler -O0 -DRBD_REAL=float '-DRBD_SQRT(x)=(float)sqrtl((long double)(x))'
    if with clang-19 && runs fma; then gives RBD_ERR_ARITHMETIC clang-19 -O2 -mfma -ffp-contract=fast; fi
    if with gcc && ! gcc -std=c99 -mfpmath=387 -w -fsyntax-only -DEXPECTED=0 -I"$root" "$scratch/rod.c" 2>"$scratch/messages" &&
        grep -q 'rbd: RBD_REPRODUCIBLE: x87' "$scratch/messages"; then
        echo "ok: x87 is refused"
    else
        failures=$((failures + 1)) && echo "FAILED: x87 is not refused"
    fi
fi

# ---- other machines ----

# foreign NAME COMPILER EMULATOR OPTION...
foreign() {
    foreign_name=$1 foreign_compiler=$2 emulator=$3
    shift 3
    # shellcheck disable=SC2086 # words wanted
    with $foreign_compiler $emulator || { emulator=; return 0; }
    link='-static -lm'
    for level in 0 1 2 3 s; do build "$foreign_compiler" -O"$level" $quickly "$@"; done
    robots=hyq
    build_code "$foreign_compiler" -O2 "$@"
    robots=iiwa
    emulator='' link=''
}
if [ "$how" != light ]; then
    foreign aarch64 aarch64-linux-gnu-gcc qemu-aarch64
    foreign i386 i686-linux-gnu-gcc qemu-i386 -msse2 -mfpmath=sse
    dialect=gnu99 # in c99 s390x computes floats as doubles
    foreign s390x s390x-linux-gnu-gcc qemu-s390x
    dialect=c99
    foreign armhf arm-linux-gnueabihf-gcc qemu-arm
    foreign armhf arm-linux-gnueabihf-gcc qemu-arm -mfpu=neon-vfpv4 -ffp-contract=fast
    foreign riscv64 riscv64-linux-gnu-gcc qemu-riscv64
    scalars=double dialect=c99 foreign s390x s390x-linux-gnu-gcc qemu-s390x -march=z14
    if with wine; then # it wants .exe, which MinGW's gcc appends, and prints carriage returns
        printf '#!/bin/sh\nWINEDEBUG=-all wine "$1.exe" | tr -d "\\r"\n' >"$scratch/wine"
        chmod +x "$scratch/wine"
        foreign windows x86_64-w64-mingw32-gcc "$scratch/wine"
    fi
fi

# ---- WebAssembly, in node ----

webassembly() {
    with clang-19 wasm-ld-19 node || return 0
    [ -e /usr/lib/wasm32-wasi/libc.a ] || { missing="$missing wasi-libc"; return 0; }
    emulator="node $root/web/wasm/node.mjs" machine=--target=wasm32-wasi link='-lm -Wl,-z,stack-size=8388608'
    for level; do
        build clang-19 -O"$level" $quickly --target=wasm32-wasi
        build clang-19 -O"$level" $quickly --target=wasm32-wasi -msimd128
    done
    emulator='' machine='' link=''
}
case $how$all_tests in
light) echo "SKIPPED but by ./run test --all: tcc, RBD_FEATURES, wasm and a Cortex-M4F" ;;
light*) scalars=double webassembly 1 ;;
*) webassembly 0 1 2 3 s ;;
esac

# ---- microcontrollers ----

# board NAME MACHINE OPTION...: of Arm, or `virt` of RISC-V
board() {
    board_name=$1 board=$2 memory='-Wl,--defsym=__flash=0 -Wl,--defsym=__ram=0x20000000'
    cross=arm-none-eabi emulator_of=qemu-system-arm more='-mthumb'
    case $board_name in
    rv32*) cross=riscv64-unknown-elf emulator_of=qemu-system-riscv32 more='-misa-spec=2.2 -mcmodel=medany'
           memory='-Wl,--defsym=__flash=0x80000000 -Wl,--defsym=__ram=0x80400000' ;;
    esac
    shift 2
    with $cross-gcc $emulator_of || return 0
    [ -e /usr/lib/picolibc/$cross ] || { missing="$missing picolibc"; return 0; }
    semihosting='-semihosting-config enable=on,target=native,chardev=con'
    [ "$board" != virt ] || board='virt -bios none'
    emulator="timeout 3600 $emulator_of -M $board -display none -monitor none -serial none -chardev stdio,id=con $semihosting -kernel"
    machine="$* $more --specs=picolibc.specs --crt0=semihost --oslib=semihost"
    link="-Wl,--gc-sections -Wl,--defsym=__stack_size=0x10000 $memory -Wl,--defsym=__flash_size=0x400000 -Wl,--defsym=__ram_size=0x400000 -lm"
    # shellcheck disable=SC2086 # words wanted
    for level in ${levels_of_boards}; do
        build $cross-gcc -O$level "$@" $more $quickly --specs=picolibc.specs -fno-math-errno -ffunction-sections
    done
    robots=hyq
    # shellcheck disable=SC2086 # words wanted
    [ "$how" = light ] || build_code $cross-gcc -O2 "$@" $more --specs=picolibc.specs -fno-math-errno -ffunction-sections
    robots=iiwa
    # The sum of doubles of libgcc's assembly for ARMv7-M rounds wrongly: refused.
    # shellcheck disable=SC2086 # words wanted
    case $board_name in
    cortex-m3 | cortex-m4f) gives RBD_ERR_ARITHMETIC $cross-gcc -Os -DRBD_REAL=double $machine ;;
    esac
    emulator='' machine='' link=''
}
levels_of_boards=g
[ "$how" = light ] || levels_of_boards="2 s"
# Doubles are calls there, of a libgcc that rounds them wrongly: board.
scalars=float
[ "$how$all_tests" = light ] || board cortex-m4f mps2-an386 -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16
if [ "$how" != light ]; then
    board cortex-m3 mps2-an385 -mcpu=cortex-m3 -mfloat-abi=soft
    scalars="double float"
    board cortex-m7 mps2-an500 -mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16
    board cortex-m0 mps2-an385 -mcpu=cortex-m0 -mfloat-abi=soft # whose code an M3 runs
    board rv32imafc virt -march=rv32imafc -mabi=ilp32f
    board rv32imac virt -march=rv32imac -mabi=ilp32
fi

echo "$checks checks, $failures failed; missing:${missing:- nothing}"
[ "$checks" -gt 0 ] && [ "$failures" -eq 0 ]
