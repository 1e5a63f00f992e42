#!/bin/bash
# The benchmark of generated code on a GPU. README.md beside this file says what is measured.
#   gpu.sh build FOLDER         generates code and compiles the programs: needs nvcc and build/tools/rbd-codegen
#   gpu.sh check FOLDER OUT     compares every kernel with double precision; times one size (two minutes)
#   gpu.sh all FOLDER OUT       all sizes, profiler counters (six minutes)
# OUT gets results.csv, registers.csv, counters.csv, machine.txt and what the examples print. Environment: ARCH (sm_90), NVCC, RBD_CODEGEN,
# ROBOTS ("iiwa hyq atlas"), SCALARS ("float double"); GRID, a folder with checkouts GRiD and GRiDBenchmarks, whose kernels
# are timed too; WORK, where code and objects go (FOLDER/build); PROFILE_SECONDS, the most for the profiler (120). FOLDER can
# then be taken to another machine.
# SPDX-License-Identifier: MIT
set -u
here=$(cd "$(dirname "$0")" && pwd)
what=${1-} folder=${2-} out=${3-.}

usage() {
    sed -n '2,5p' "$0" >&2
    exit 2
}

urdf_of() {
    case $1 in
    grid_*) echo "$GRID/GRiDBenchmarks/urdfs/${1#grid_}.urdf" ;;
    *) echo "$root/models/$1.urdf" ;;
    esac
}

# A derivative of Atlas's forward dynamics in one function keeps the compiler busy for minutes: it has parts alone.
algorithms_of() {
    case $1.$2 in
    iiwa.*) echo id mm minv fd fd_cholesky id_derivatives fd_derivatives ;;
    hyq.float) echo id mm minv fd fd_cholesky id_derivatives fd_derivatives constrained ;;
    hyq.double) echo id mm minv fd id_derivatives ;;
    atlas.float) echo id mm minv fd id_derivatives ;;
    atlas.double) echo id mm fd ;;
    grid_*) echo id fd_derivatives ;;
    esac
}

programs_of() {
    case $1.$2 in
    hyq.float | atlas.float) echo main rollout parts ;;
    grid_*) echo main ;;
    *) echo main rollout ;;
    esac
}

# options_of ROBOT LIST
options_of() {
    case $1 in hyq | atlas) echo --floating ;; esac
    case $2 in *constrained*) echo --constraints "$root/models/$1_feet.csv" ;; esac
}

# The code of a robot: NAME_code.cuh in the scalar, and the C in double that it is compared with.
generate() {
    local robot=$1 scalar=$2 list
    list=$(algorithms_of "$robot" "$scalar" | tr ' ' ,)
    mkdir -p "$work/$scalar" "$work/reference"
    # shellcheck disable=SC2046
    [ "$work/$scalar/${robot}_code.cuh" -nt "$codegen" ] ||
        "$codegen" "$(urdf_of "$robot")" --name "$robot" --cuda --scalar "$scalar" --algorithm "$list" $(options_of "$robot" "$list") \
            --output "$work/$scalar" || return 1
    [ -f "$work/reference/$robot.o" ] && return
    list=$(algorithms_of "$robot" float | tr ' ' ,)
    case $list in *fd_derivatives*) ;; *) list=$list,fd_derivatives ;; esac
    # shellcheck disable=SC2046
    "$codegen" "$(urdf_of "$robot")" --name "${robot}_ref" --algorithm "$list" $(options_of "$robot" "$list") \
        --output "$work/reference" &&
        cc -O1 -c "$work/reference/${robot}_ref_code.c" -o "$work/reference/$robot.o"
}

# Layouts beside blocks: what large kernels keep out of registers hides what the layout costs, and they compile for minutes.
layouts_of() {
    case $1.$2.$3 in
    *.float.id | *.float.mm | *.float.fd) echo -DWITH_ROWS -DWITH_COLUMNS ;;
    iiwa.* | hyq.float.minv | *.double.id | *.double.mm | *.double.fd) echo -DWITH_ROWS ;;
    esac
}

# One source file for a robot in a scalar: compile ROBOT SCALAR SOURCE [ALGORITHM].
compile() {
    local robot=$1 scalar=$2 source=$3 algorithm=${4-}
    local object=$work/$scalar/$robot.$source$algorithm.o
    [ "$object" -nt "$work/$scalar/${robot}_code.cuh" ] && [ "$object" -nt "$here/$source.cu" ] &&
        [ "$object" -nt "$here/kernel.h" ] && return
    # shellcheck disable=SC2046
    "$nvcc" -std=c++17 -O3 -arch="$arch" -Xptxas -v -Xfatbin=-compress-all -DROBOT="$robot" -DSCALAR="$scalar" ${algorithm:+-DALGORITHM=$algorithm} \
        $(layouts_of "$robot" "$scalar" "$algorithm") -DCONSTRAINT_ROWS=12 -DCODE_HEADER="\"${robot}_code.cuh\"" -DREFERENCE_HEADER="\"${robot}_ref_code.h\"" \
        -I"$here" -I"$work/$scalar" -I"$work/reference" -c "$here/$source.cu" -o "$object" >"$object.log" 2>&1 ||
        { cat "$object.log"; return 1; }
}

# GRiD's flags are its own.
build_grid() {
    local robot=$1 name=${1#grid_}
    mkdir -p "$work/$robot"
    [ -f "$work/$robot/grid.cuh" ] ||
        (cd "$work/$robot" && "${PYTHON:-python3}" "$GRID/GRiD/generateGRiD.py" "$GRID/GRiDBenchmarks/urdfs/$name.urdf") || return 1
    "$nvcc" -std=c++17 -O3 -arch="$arch" -ftz=true -prec-div=false -prec-sqrt=false -cudart static -DROBOT="$robot" \
        -DREFERENCE_HEADER="\"${robot}_ref_code.h\"" -I"$here" -I"$work/reference" -I"$work/$robot" "$here/grid.cu" \
        "$work/reference/$robot.o" -o "$folder/$robot.peer"
}

# What else runs: the examples, and all that a machine without this checkout needs.
build_examples() {
    local examples=$root/examples/gpu
    "$codegen" "$(urdf_of iiwa)" --name iiwa --cuda --scalar float --algorithm id,fd,pose:lbr_iiwa_link_7 --output "$folder" &&
        "$codegen" "$(urdf_of cart_pole)" --name cart_pole --cuda --scalar float --algorithm fd --output "$folder" &&
        "$nvcc" -std=c++17 -O3 -arch="$arch" -cudart static -I"$folder" "$examples/mppi.cu" -o "$folder/mppi" || return 1
    [ "$folder/falling" -nt "$examples/falling.cu" ] || # minutes
        "$nvcc" -std=c++17 -O3 -arch="$arch" -cudart static -I"$root" "$examples/falling.cu" -o "$folder/falling" || return 1
    cp "$examples/rbd_cuda.py" "$examples/batch.py" "$here/gpu.sh" "$here/report.py" "$folder"
}

run_examples() {
    local robots
    timeout 60 "$folder/mppi" 1024 times >"$out/mppi.txt" 2>&1
    timeout 60 "$folder/mppi" 16384 times >>"$out/mppi.txt" 2>&1
    timeout 90 python3 "$folder/batch.py" "$folder/iiwa_code.cuh" >"$out/python.txt" 2>&1
    [ -x "$folder/falling" ] || return
    for robots in 1000 16896 50688; do timeout 60 "$folder/falling" $robots 1000; done >"$out/falling.txt" 2>&1
}

build() {
    root=$(cd "$here/../.." && pwd) work=${WORK:-$folder/build} arch=${ARCH:-sm_90}
    nvcc=${NVCC:-$(command -v nvcc || echo /usr/local/cuda/bin/nvcc)} codegen=${RBD_CODEGEN:-$root/build/tools/rbd-codegen}
    mkdir -p "$work" "$folder"
    local robots=${ROBOTS:-iiwa hyq atlas} robot scalar algorithm source
    [ -n "${GRID-}" ] && robots="$robots grid_iiwa grid_hyq"
    for scalar in ${SCALARS:-float double}; do
        for robot in $robots; do
            [ "$scalar" = double ] && [ "${robot#grid_}" != "$robot" ] && continue
            echo "$robot $scalar"
            generate "$robot" "$scalar" || return 1
            for algorithm in $(algorithms_of "$robot" "$scalar"); do compile "$robot" "$scalar" kernel "$algorithm" || return 1; done
            for source in $(programs_of "$robot" "$scalar"); do compile "$robot" "$scalar" "$source" || return 1; done
            "$nvcc" -arch="$arch" -cudart static "$work/$scalar/$robot".*.o "$work/reference/$robot.o" \
                -o "$folder/$robot.$scalar" || return 1
            [ "${robot#grid_}" = "$robot" ] || build_grid "$robot" || return 1
        done
    done
    python3 "$here/registers.py" "$work" >"$folder/registers.csv" || return 1
    build_examples
}

describe_machine() {
    date -u +%F
    nvidia-smi --query-gpu=name,driver_version,memory.total,clocks.sm,clocks.max.sm,clocks.mem,temperature.gpu,power.draw \
        --format=csv
    nvcc --version 2>/dev/null | tail -2
}

# measure OPTION...: all programs, one after the other; the rows go to results.csv.
measure() {
    local program status
    echo program,robot,scalar,algorithm,layout,states,error,right,microseconds,states_per_s,GB_per_s >"$out/results.csv"
    for program in "$folder"/*.float "$folder"/*.double "$folder"/*.peer; do
        [ -x "$program" ] || continue
        timeout 120 "$program" "$@" >>"$out/results.csv" 2>>"$out/errors.txt"
        status=$?
        [ $status = 0 ] || echo "${program##*/}: exit status $status" >>"$out/errors.txt"
    done
}

metrics=gpu__time_duration.sum,dram__throughput.avg.pct_of_peak_sustained_elapsed,\
smsp__issue_active.avg.pct_of_peak_sustained_active,sm__warps_active.avg.pct_of_peak_sustained_active,\
dram__bytes.sum,lts__t_bytes.sum,l1tex__t_bytes_pipe_lsu_mem_local_op_ld.sum,smsp__inst_executed.sum,\
smsp__average_warps_issue_stalled_no_instruction_per_issue_active.ratio,\
smsp__average_warps_issue_stalled_long_scoreboard_per_issue_active.ratio,\
smsp__average_warps_issue_stalled_lg_throttle_per_issue_active.ratio,\
smsp__thread_inst_executed_per_inst_executed.ratio

# The profiler's counters of one kernel: counters ROBOT ALGORITHM [LAYOUT [MEASUREMENT]].
counters() {
    local layout=${3-blocks}
    keep_counters "$1,$2,$layout" "$2_kernel" 0 "$folder/$1.float" --only "${4-$2}" --layout "$layout" --profile
}

# keep_counters NAME KERNEL LAUNCHES_BEFORE PROGRAM ARGUMENT...
keep_counters() {
    local name=$1 kernel=$2 before=$3 left=$((profile_end - SECONDS)) log
    shift 3
    if [ $left -gt 0 ]; then
        log=$(timeout -k 5 $left ncu --clock-control none --kernel-name "regex:$kernel" --launch-skip "$before" \
            --launch-count 1 --csv --metrics "$metrics" "$@" 2>&1)
    fi
    if [ $SECONDS -ge "$profile_end" ]; then
        echo "$name: no counters, the profiler's time was over" >>"$out/unprofiled.txt"
        return
    fi
    grep '^"[0-9]' <<<"$log" | sed "s/^/$name,/" >>"$out/counters.csv"
    grep '^==ERROR' <<<"$log" | sed "s/^/$name: /" >>"$out/errors.txt"
}

# All kernels within PROFILE_SECONDS; what spills comes first.
profile() {
    local algorithm profile_end=$((SECONDS + ${PROFILE_SECONDS:-120}))
    command -v ncu >/dev/null || return
    counters iiwa id
    [ "$1" = check ] && return
    for algorithm in fd_derivatives constrained id_derivatives; do counters hyq $algorithm; done
    for algorithm in minv id_derivatives fd; do counters atlas $algorithm; done
    counters atlas product blocks fd_derivatives_in_parts
    [ -x "$folder/falling" ] && keep_counters hyq,contact_step,columns fall_kernel 1 "$folder/falling" 50688 20
    for algorithm in fd fd_derivatives; do counters iiwa $algorithm; done
    for algorithm in id mm; do counters iiwa $algorithm rows; done
    for algorithm in id fd minv; do counters hyq $algorithm; done
    for algorithm in id mm; do counters atlas $algorithm; done
}

# After each part: when it ended, and the page of what there is, so that a run that is cut off leaves one.
part_done() {
    echo "$1: until second $SECONDS" >>"$out/machine.txt"
    python3 "$here/report.py" "$out" >"$out/printed.txt"
}

case $what in
build)
    [ -n "$folder" ] || usage
    build
    ;;
check | all)
    [ -n "$folder" ] || usage
    mkdir -p "$out"
    for file in errors.txt counters.csv unprofiled.txt; do : >"$out/$file"; done
    describe_machine >"$out/machine.txt" 2>&1
    cp "$folder/registers.csv" "$out" 2>/dev/null
    if [ "$what" = check ]; then measure --check; else measure; fi
    part_done kernels
    run_examples
    part_done examples
    profile "$what"
    nvidia-smi --query-gpu=clocks.sm,temperature.gpu,power.draw --format=csv >>"$out/machine.txt" 2>&1
    part_done profiler
    status=$?
    cat "$out/printed.txt"
    exit $status
    ;;
*) usage ;;
esac
