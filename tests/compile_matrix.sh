#!/bin/sh
# Compiles rbd.h, and the headers that stand on it, with every compiler found, as every standard, with all warnings as errors:
# declarations only, with the implementation, with RBD_STATIC (for double alone, a keyword apart), and the declarations of
# rbd_urdf.h and rbd_mjcf.h; for double and, with the first standard, float. Without code, as a standard decides on syntax and
# meaning alone, and as clang warns of all before it writes code; GCC warns of some there: of functions without use or result
# and of cases that fall through. So with gcc the static functions, which are the same implementation, with code at -O0 by the
# first standard; it sees the rest at -O2 where the tests' library is built. Then the batch calls for several numbers of lanes,
# with the SIMD unit for them where the compiler has it; with gcc the first of them with code. clang 16 compiles the implementation
# alone, by the first standard in C and the last in C++. With RBD_ALL_TESTS=yes it compiles all as clang 19 does; float and lanes
# with the last standard too, and the standards between the first and the last; all of the first with code at -O0 by each
# compiler, and clang-19 at -O2.
# usage: compile_matrix.sh DIRECTORY_OF_RBD_H [COMPILER...]
set -u

root=${1:?usage: compile_matrix.sh DIRECTORY_OF_RBD_H [COMPILER...]}
shift
[ $# -gt 0 ] || set -- gcc g++ clang clang++ clang-16 clang++-16 clang-19 clang++-19
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
warnings="-pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Wvla -Wundef -Werror"
quick="-O0 -Dalways_inline=unused"
all_tests=${RBD_ALL_TESTS-}
failures=0
combinations=0

# The three ways to include, as C and as C++ file.
for suffix in c cpp; do
    sed 's/.*/#include "&"/' "$root/src/headers.txt" >"$scratch/declarations.$suffix"
    printf '#include "rbd_urdf.h"\n#include "rbd_mjcf.h"\n' >"$scratch/urdf.$suffix"
    {
        echo '#define RBD_IMPLEMENTATION'
        grep -v batch "$root/src/headers.txt" | sed 's/.*/#include "&"/'
    } >"$scratch/implementation.$suffix"
    {
        echo '#define RBD_STATIC'
        cat "$scratch/implementation.$suffix"
    } >"$scratch/static.$suffix"
    for lanes in 2 4 8; do
        printf '#define RBD_LANES %s\n#define RBD_BATCH_IMPLEMENTATION\n#include "rbd_derivatives.h"\n#include "rbd_constraints.h"\n#include "rbd_batch.h"\n' "$lanes" \
            >"$scratch/batch-$lanes.$suffix"
    done
done

# compile COMPILER STANDARD SUFFIX INCLUDED SCALAR FLAGS
compile() {
    # shellcheck disable=SC2086 # words wanted
    if "$1" -std="$2" $warnings $6 -DRBD_REAL="$5" -I"$root" -c "$scratch/$4.$3" \
        -o "$scratch/out.o" >"$scratch/messages" 2>&1; then
        result=ok
    else
        result=FAILED
        failures=$((failures + 1))
    fi
    combinations=$((combinations + 1))
    printf '%-12s %-6s %-15s %-7s %-30s  %s\n' "$1" "$2" "$4" "$5" "$6" "$result"
    [ "$result" = ok ] || sed -n '1,20p' "$scratch/messages"
}

# level_of COMPILER: of what it compiles with the first standard
level_of() {
    case $all_tests$1 in
    clang* | g++) echo -fsyntax-only ;;
    *) echo "$quick" ;;
    esac
}

# all COMPILER SUFFIX STANDARD...
all() {
    compiler=$1 suffix=$2 level=$(level_of "$1") first=$3
    shift 2
    # in two thirds of the time without forced inlining
    [ "$compiler$all_tests" != clang-19yes ] ||
        compile "$compiler" "$1" "$suffix" implementation double "-O2 -Dalways_inline=unused"
    for standard; do
        level_of_this=$level level=-fsyntax-only
        case $standard in c11 | c++14 | c++17) # between standards in which all is compiled
            [ -z "$all_tests" ] || compile "$compiler" "$standard" "$suffix" implementation double $level
            continue ;;
        esac
        scalars="double float"
        [ -n "$all_tests" ] || [ "$standard" = "$first" ] || scalars=double
        for scalar in $scalars; do
            for included in declarations urdf implementation; do
                level_of_included=-fsyntax-only
                [ -z "$all_tests" ] || level_of_included=$level_of_this
                compile "$compiler" "$standard" "$suffix" "$included" "$scalar" "$level_of_included"
            done
        done
        compile "$compiler" "$standard" "$suffix" static double "$level_of_this"
    done
}

# batch COMPILER STANDARD SUFFIX LANES SCALAR LEVEL [SIMD_FLAG]: without that flag where the compiler has it not;
# GCC then notes that vectors are passed in memory.
batch() {
    flags=$6
    if [ -n "${7-}" ] && "$1" -Werror "$7" -I"$root" -fsyntax-only "$scratch/declarations.$3" 2>/dev/null
    then
        flags="$6 $7"
    elif [ -n "${7-}" ]; then
        flags="$6 -Wno-psabi"
    fi
    compile "$1" "$2" "$3" "batch-$4" "$5" "$flags"
}

# batches COMPILER SUFFIX STANDARD...
batches() {
    compiler=$1 suffix=$2 level=$(level_of "$1") first=$3
    shift 2
    for standard; do
        batch "$compiler" "$standard" "$suffix" 2 double "$level"
        level=-fsyntax-only
        [ -n "$all_tests" ] || [ "$standard" = "$first" ] || continue
        batch "$compiler" "$standard" "$suffix" 4 double "$level" -mavx2
        batch "$compiler" "$standard" "$suffix" 8 double "$level" -mavx512f
        batch "$compiler" "$standard" "$suffix" 8 float "$level" -mavx2
    done
}

for compiler; do
    command -v "$compiler" >/dev/null 2>&1 || continue
    case $all_tests$compiler in
    clang-16) compile clang-16 c99 c implementation double -fsyntax-only ;;
    clang++-16) compile clang++-16 c++20 cpp implementation double -fsyntax-only ;;
    *++*)
        all "$compiler" cpp c++11 c++14 c++17 c++20
        batches "$compiler" cpp c++11 c++20
        ;;
    *)
        all "$compiler" c c99 c11 c17
        batches "$compiler" c c99
        ;;
    esac
done

[ -n "$all_tests" ] || echo "SKIPPED but by ./run test --all: float and lanes with the last standard, those between, clang-16, clang-19 -O2"
echo "$combinations combinations, $failures failed"
[ "$combinations" -gt 0 ] && [ "$failures" -eq 0 ]
