#!/bin/sh
# rbd-codegen built by another compiler writes the same bytes: GCC and clang evaluate arguments in opposite orders.
# usage: same_text.sh ROOT RBD_CODEGEN LIBRARY...   the libraries of tools/, but that of the code generator; CXX built them
set -u
root=$(realpath "$1") rbd_codegen=$(realpath "$2")
shift 2
libraries=$(realpath "$@")
case ${CXX:-c++} in *clang*) other=g++ ;; *) other=clang++-19 ;; esac
command -v $other >/dev/null || { echo "skipped: there is no $other"; exit 77; }
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1

compile() { # SOURCE OBJECT ARGUMENT...
    source=$1 object=$2
    shift 2
    $other -std=c++17 -ffp-contract=off -Dalways_inline=unused -Wno-deprecated-declarations -I"$root" -I"$root/tools" "$@" \
        -c "$root/tools/$source" -o "$object"
}
for scalar in double float; do
    compile codegen/record.cpp record_$scalar.o -DCONSTANTS=$scalar -DRECORD=record_$scalar -DRECORD_SPACE=of_$scalar || exit 1
done
for source in graph program emit sines compute limbs; do
    compile codegen/$source.cpp $source.o -O1 || exit 1
done
# shellcheck disable=SC2046 # words wanted
compile rbd_codegen.cpp rbd_codegen.o $(pkg-config --cflags urdfdom) || exit 1
# shellcheck disable=SC2046,SC2086 # words wanted
$other ./*.o $libraries $libraries $(pkg-config --libs urdfdom) -lm -o other || exit 1

mkdir here there
compared=0 failed=0
compare() { # MODEL ARGUMENT...
    model=$root/models/$1.urdf
    shift
    "$rbd_codegen" --output here --name code "$@" "$model" && ./other --output there --name code "$@" "$model" || exit 1
    for file in code_code.h code_code.c; do # but the line with the folder
        sed -i '/^       rbd-codegen /d' here/$file there/$file
        cmp here/$file there/$file || { echo "FAILED: $other writes another $file: $* $model"; failed=1; }
        compared=$((compared + 1))
    done
}
all=$("$rbd_codegen" --help | tr ' ' '\n' | sed -n '/^id$/,/^--scalar$/p' | grep -v ':LINK\|^--\|^$' | paste -sd,)
for model in cart_pole double_pendulum five_bar iiwa pendulum; do
    compare $model --algorithm "$all"
done
compare hyq --floating --algorithm "$all"
compare hyq --floating --limbs 4 --f-ext --gravity-argument --algorithm "$all"
compare atlas --algorithm id,mm,fd,minv,id_derivatives
compare atlas --floating --limbs 2 --scalar float --algorithm id,mm_packed,fd
compare iiwa --scalar float --bounded-angles --short-sums --algorithm "$all,jacobian:lbr_iiwa_link_7,pose:lbr_iiwa_link_7"
compare cart_pole --lanes 4 --f-ext --bounded-angles --block 50 --algorithm "$all"
[ $compared -eq 22 ] || { echo "FAILED: $compared files compared"; failed=1; }
exit $failed
