#!/bin/sh
# rbd-codegen built by another compiler writes the same bytes: GCC and clang evaluate arguments in opposite orders.
# usage: same_text.sh ROOT RBD_CODEGEN CODEGEN_WRITE LIBRARY...   LIBRARY: those of tools/ without the code generator's,
#     that of the random robots, and that of MJCF files where MUJOCO links it; CXX built all
set -u
root=$(realpath "$1") rbd_codegen=$(realpath "$2") write=$(realpath "$3")
shift 3
libraries=$(realpath "$@")
case ${CXX:-c++} in *clang*) other=g++ ;; *) other=clang++-19 ;; esac
command -v $other >/dev/null || { echo "skipped: there is no $other"; exit 77; }
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1

compile() { # SOURCE OBJECT ARGUMENT...
    source=$1 object=$2
    shift 2
    $other -std=c++17 -ffp-contract=off -Dalways_inline=unused -Wno-deprecated-declarations -I"$root" -I"$root/tools" \
        -I"$(dirname "$rbd_codegen")" "$@" \
        -c "$root/tools/$source" -o "$object"
}
for scalar in double float; do
    compile codegen/record.cpp record_$scalar.o -DCONSTANTS=$scalar -DRECORD=record_$scalar -DRECORD_SPACE=of_$scalar || exit 1
    compile codegen/own_sines.cpp own_sines_$scalar.o -DSCALAR=$scalar || exit 1
done
for source in "$root"/tools/codegen/*.cpp; do
    name=$(basename "$source" .cpp)
    case $name in record | own_sines) continue ;; esac # above
    compile codegen/$name.cpp $name.o -O1 || exit 1
done
generator=$(echo ./*.o)
compile ../tests/codegen/write.cpp write.o || exit 1
# shellcheck disable=SC2046 # words wanted
compile rbd_codegen.cpp rbd_codegen.o $(pkg-config --cflags urdfdom) || exit 1
# shellcheck disable=SC2046,SC2086 # words wanted
$other rbd_codegen.o $generator $libraries $libraries $(pkg-config --libs urdfdom) ${MUJOCO-} -lm -o other || exit 1
# shellcheck disable=SC2086 # words wanted
$other write.o $generator $libraries -lquadmath -lm -o other_write || exit 1

mkdir here there
compared=0 failed=0
compare() { # MODEL ARGUMENT...
    model=$root/models/$1.urdf
    shift
    rm -f here/code_code.* there/code_code.*
    "$rbd_codegen" --output here --name code "$@" "$model" && ./other --output there --name code "$@" "$model" || exit 1
    for file in $(cd here && ls code_code.*); do # but the line with the folder
        sed -i '/^       rbd-codegen /d' here/$file there/$file
        cmp here/$file there/$file || { echo "FAILED: $other writes another $file: $* $model"; failed=1; }
        compared=$((compared + 1))
    done
}
printf 'body1,x1,axes\nlf_lowerleg,0.33,000111\nrh_lowerleg,0.33,000111\n' >feet.csv
printf 'body1,axes,kp\nlbr_iiwa_link_7,111000,9\n' >hand.csv
all=$("$rbd_codegen" --help | tr ' ' '\n' | sed -n '/^id$/,/^--constraints$/p' | grep -v ':LINK\|^--\|^$' | paste -sd,)
compare iiwa --scalar float --bounded-angles --short-sums --constraints hand.csv --algorithm "$all,jacobian:lbr_iiwa_link_7,pose:lbr_iiwa_link_7"
compare five_bar --lanes 4 --f-ext --bounded-angles --block 50 --constraints "$root/models/five_bar_loop.csv" --algorithm "$all"
printf 'lf_lowerleg,rh_lowerleg\nrh_lowerleg\nnone\n' >gait.csv
compare hyq --floating --constraints feet.csv --stances gait.csv --algorithm "$all"
compare hyq --floating --reproducible --scalar float --constraints feet.csv --algorithm "${all%,delta,constrained_id}"
compare hyq --floating --limbs 4 --gravity-argument --constraints feet.csv --algorithm "$all"
compare atlas --floating --limbs 2 --algorithm id,mm_packed,fd
compare hyq --floating --cuda --algorithm id,fd

# random robots, with joints of all types
"$write" robot 10 double 1 1 600 long 0 here && ./other_write robot 10 double 1 1 600 long 0 there || exit 1
for file in here/robot*; do
    cmp "$file" there/"${file#here/}" || { echo "FAILED: $other writes another ${file#here/}"; failed=1; }
    compared=$((compared + 1))
done
[ $compared -eq 33 ] || { echo "FAILED: $compared files compared"; failed=1; }
exit $failed
