#!/bin/sh
# The benchmark of a GPU without one: its programs compile by a C++ compiler, find the kernels of a small robot right, and
# find one wrong that is. The report has all of its rows.
# usage: test.sh ROOT RBD_CODEGEN
set -eu
root=$1 codegen=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
urdf=$root/models/double_pendulum.urdf

"$codegen" "$urdf" --name robot --cuda --scalar float --algorithm id,minv,fd,id_derivatives --output "$scratch"
"$codegen" "$urdf" --name robot_ref --algorithm id,minv,fd,id_derivatives,fd_derivatives --output "$scratch"
${CC:-cc} -O0 -c "$scratch/robot_ref_code.c" -o "$scratch/reference.o"

# program NAME SOURCE[:ALGORITHM]...
program() {
    name=$1
    shift
    objects=
    for part in "$@"; do
        ${CXX:-c++} -x c++ -std=c++17 -O0 -Wall -Wextra -Werror -DROBOT=robot -DSCALAR=float -DALGORITHM="${part#*:}" -DWITH_ROWS \
            -DWITH_COLUMNS -DCODE_HEADER='"robot_code.cuh"' -DREFERENCE_HEADER='"robot_ref_code.h"' -I"$root/bench/gpu" \
            -I"$scratch" -c "$root/bench/gpu/${part%:*}.cu" -o "$scratch/$part.o"
        objects="$objects $scratch/$part.o"
    done
    # shellcheck disable=SC2086 # a list of files
    ${CXX:-c++} $objects "$scratch/reference.o" -o "$scratch/$name"
}

echo program,robot,scalar,algorithm,layout,states,error,right,microseconds,states_per_s,GB_per_s >"$scratch/results.csv"
program right main rollout parts kernel:id kernel:fd kernel:minv kernel:id_derivatives
"$scratch/right" --check --most 1003 >>"$scratch/results.csv"
python3 "$root/bench/gpu/report.py" "$scratch" >"$scratch/report"
for row in 'robot id' 'robot rollout' 'robot fd_derivatives_in_parts' ' 0 wrong'; do
    grep -q "$row" "$scratch/report" || { echo "no '$row' in the report"; exit 1; }
done

# For a profiler each kernel is launched, and nothing is printed.
"$scratch/right" --profile --most 64 >"$scratch/printed"
[ ! -s "$scratch/printed" ]

# The script, with a profiler that does not end: the page says so.
mkdir "$scratch/folder" "$scratch/path"
printf '#!/bin/sh\n"%s" --check --most 1003 --only id\n' "$scratch/right" >"$scratch/folder/robot.float"
printf '#!/bin/sh\nexec sleep 60\n' >"$scratch/path/ncu"
chmod +x "$scratch/folder/robot.float" "$scratch/path/ncu"
PATH=$scratch/path:$PATH PROFILE_SECONDS=1 "$root/bench/gpu/gpu.sh" all "$scratch/folder" "$scratch/out" >"$scratch/printed" || true
for row in 'robot id' 'iiwa,id,blocks: no counters' 'atlas,mm,blocks: no counters' 'kernels: until second'; do
    grep -q "$row" "$scratch/out/report.md" || { echo "no '$row' on the page of a run that was cut off"; exit 1; }
done

# A robot of another mass is not the same.
sed 's/<mass value="[^"]*"/<mass value="3.21"/' "$urdf" >"$scratch/other.urdf"
"$codegen" "$scratch/other.urdf" --name robot --cuda --scalar float --algorithm id,minv,fd,id_derivatives --output "$scratch"
program wrong main kernel:id
if "$scratch/wrong" --check --most 1003 >"$scratch/printed"; then
    echo "a wrong kernel was found right"
    exit 1
fi
grep -q WRONG "$scratch/printed"
