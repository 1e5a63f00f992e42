#!/bin/sh
# The fuzzer of generated code: all functions of random robots, and of the models, give rbd.h's results when gcc and clang
# compile them with ASan and UBSan. Robot k is the same on every machine, with its options and its states.
# usage: fuzz.sh ROOT RBD_CODEGEN CODEGEN_FUZZ FOLDER [models | ROBOTS [FIRST]]
#     the models and 200 robots; or one of the two. Prints a line for each; what is wrong stays in FOLDER.
set -u
flags="-std=c99 -O1 -march=native -w -fsanitize=address,undefined -fno-sanitize=pointer-overflow,null -fno-sanitize-recover=all"

# --one FOLDER PROGRAM ARGUMENT...: writes code, says what it is, its name first, and compiles it; for xargs
if [ "$1" = --one ]; then
    cd "$2" || exit 1
    shift 2
    about=$("$@" 2>&1) || { echo "not written: $*: $about"; exit 1; }
    echo "$about"
    name=${about%%:*} failed=0
    upper=$(echo "$name" | tr a-z A-Z)
    for cc in gcc "clang-19 -fno-sanitize=alignment"; do # which takes clang half of its time
        compiler=${cc%% *}
        # shellcheck disable=SC2086 # words wanted
        $compiler $flags ${cc#$compiler} "-D${upper}_SELFTEST" "-D${upper}_SELFTEST_MAIN" -o "$name.$compiler" "${name}_code.c" -lm >"$name.$compiler.out" 2>&1 &&
            "./$name.$compiler" >>"$name.$compiler.out" 2>&1 && continue
        echo "$name: WRONG by $compiler, see $name.$compiler.out and ${name}_code.c"
        grep -v ': right$' "$name.$compiler.out" | head -n 5
        failed=1
    done
    [ $failed -ne 0 ] || rm -f "${name}"_code.[ch] "$name".gcc* "$name".clang* "$name.csv" "$name.stances"
    exit $failed
fi
# --model RBD_CODEGEN NAME URDF OPTION...: writes all functions of a model, those of a link for its last one; by limbs for
# two stances, in which that is held and not
if [ "$1" = --model ]; then
    rbd_codegen=$2 name=$3 urdf=$4
    shift 4
    link=$(sed -n 's/.*<link name="\([^"]*\)".*/\1/p' "$urdf" | tail -n 1)
    printf 'body1,x1,y1,z1,axes\n%s,0.1,0.2,0.3,000001\n' "$link" >"$name.csv"
    all=$("$rbd_codegen" --help | sed -n '/there are$/,/^  --/p' | grep -v ' --' | tr ' ' '\n' | sed "/^$/d; s/LINK/$link/")
    printf '%s\nnone\n' "$link" >"$name.stances"
    case $* in *--limbs*) set -- "$@" --stances "$name.stances" ;; esac
    case $* in *--reproducible*) all=$(echo "$all" | grep -v '^constrained_id$\|^delta$') ;; esac
    "$rbd_codegen" --name "$name" --algorithm "$(echo "$all" | paste -sd,)" --constraints "$name.csv" "$@" "$urdf" &&
        echo "$name: $(basename "$urdf") $*, $(grep -c '^int\|^void' "${name}_code.h") functions"
    exit
fi

root=$(realpath "$1") rbd_codegen=$(realpath "$2") fuzz=$(realpath "$3")
for cc in gcc clang-19; do
    command -v $cc >/dev/null || { echo "skipped: there is no $cc"; exit 77; }
done
mkdir -p "$4" && folder=$(realpath "$4") && self=$(realpath "$0") || exit 1

robots() { # COUNT FIRST
    k=$2
    while [ "$k" -lt $(($1 + $2)) ]; do
        echo "$fuzz . $k"
        k=$((k + 1))
    done
}
models() {
    n=0
    for model in pendulum double_pendulum cart_pole five_bar iiwa hyq atlas; do
        case $model in atlas | hyq) base=--floating ;; *) base= ;; esac
        for options in "" "--limbs 4 --f-ext --gravity-argument" "--scalar float --short-sums --bounded-angles" "--reproducible --lanes 2"; do
            case $model$options in atlas*short-sums* | atlas*lanes*) continue ;; esac # gcc takes minutes
            # shellcheck disable=SC2086 # no blank at the end
            echo "$self --model $rbd_codegen m$n $root/models/$model.urdf" $base $options
            n=$((n + 1))
        done
    done
}
case ${5-} in
'') models && robots 200 0 ;;
models) models ;;
*) robots "$5" "${6-0}" ;;
esac |
    xargs -P "$(nproc)" -L 1 "$self" --one "$folder" >"$folder/report" 2>&1
status=$?
cat "$folder/report"
wrong=$(grep -c 'WRONG by\|^not written' "$folder/report")
models=$(grep -c '\.urdf' "$folder/report")
states=$(sed -n 's/.* functions, \([0-9]*\) states$/\1/p' "$folder/report" | awk '{ sum += $1 } END { print sum + 0 }')
echo "$(grep -c ' functions, .* states' "$folder/report") robots in $states states, $models models, $wrong wrong"
[ "$wrong" -eq 0 ] && [ $status -eq 0 ] && [ $((models + states)) -gt 0 ]
