#!/bin/sh
# Counts instructions, loads and stores per call; ../README.md has the method.
# usage: instructions.sh DIRECTORY [OPTION...]   works in a new folder of DIRECTORY; --help has the options
set -u

bench=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd) || exit 1
accepted=$bench/instructions.csv
header=compiler,robot,algorithm,scalar,instructions,loads,stores,variant

say() { printf '%s\n' "$*" >&2; }
# Shows a line that the next one replaces, if stderr is a terminal; an empty one erases it.
progress() { [ ! -t 2 ] || printf '\r\033[K%s' "$*" >&2; }
die() { progress; say "instructions: $*"; exit 1; }
usage_error() { say "instructions: $*"; exit 2; }
have() { command -v "$1" >/dev/null 2>&1; }

# ---- options ----

usage() {
    cat <<END
usage: ./run instructions [OPTION...]
  --format table|csv   table (the default) shows the change against bench/instructions.csv
  --accept             make these counts the ones to compare with
  --flags FLAGS        compile with FLAGS instead of -O3; nothing is compared
END
}

read_options() {
    format=table accept=no flags=-O3 compare=yes
    while [ $# -gt 0 ]; do
        case $1 in
        --format=* | --flags=*) option=${1%%=*} value=${1#*=} ;;
        --format | --flags)
            [ $# -ge 2 ] || usage_error "$1 needs a value"
            option=$1 value=$2
            shift ;;
        --accept) option=$1 ;;
        -h | --help) usage; exit 0 ;;
        *) usage_error "unknown option '$1' (--help lists them)" ;;
        esac
        case $option in
        --format) format=$value ;;
        --flags) flags=$value compare=no ;;
        --accept) accept=yes ;;
        esac
        shift
    done
    case $format in table | csv) ;; *) usage_error "--format: '$format' is neither table nor csv" ;; esac
    [ "$accept$compare" != yesno ] || usage_error "--accept: only the counts of -O3, so without --flags"
}

# ---- tools ----

# "gcc 12.2.0", as rbd-bench has it.
compiler_title() { echo "${1%%-*} $("$1" -dumpfullversion -dumpversion)"; }

# Sets $compilers: gcc and the newest clang, as far as they are there.
find_compilers() {
    compilers=
    for candidate in gcc clang-19 clang-16 clang; do
        case $compilers in *clang*) break ;; esac
        ! have "$candidate" || compilers="$compilers $candidate"
    done
    [ -n "$compilers" ] || die "neither gcc nor clang found"
    case $compilers in
    *gcc*clang*) ;;
    *) [ "$accept" = no ] || die "--accept needs gcc and clang; found only$compilers"
       say "instructions: found only$compilers" ;;
    esac
}

find_accepted() {
    accepted_now=/dev/null
    if [ "$compare" = no ] || [ ! -e "$accepted" ]; then
        return
    fi
    accepted_now=$accepted
    [ "$(head -n 1 "$accepted")" = "$header" ] || die "$accepted is no table of counts: restore or remove it"
    for compiler in $compilers; do
        title=$(compiler_title "$compiler")
        grep -q "^$title," "$accepted" ||
            say "instructions: no change shown for $title: the accepted table is of" \
                "$(sed '1d; s/,.*//' "$accepted" | uniq | paste -s -d , -)"
    done
}

# ---- counting ----

# Runs a command and shows what it printed only if it fails.
quietly() { "$@" >"$work/log" 2>&1 || { progress; cat "$work/log" >&2; die "failed: $*"; }; }

# Of a move from register to register clang's assembler takes the store's encoding where that is shorter, which
# valgrind 3.19 does not know: an assembler that asks for the load's.
make_assembler() {
    mkdir "$work/bin" || exit 1
    cat >"$work/bin/as" <<'END'
#!/bin/sh
for source; do :; done
sed -i 's/^\tvmovq\t\(%xmm[0-9]*, %xmm\)/\t{load} vmovq\t\1/' "$source"
exec as "$@"
END
    chmod +x "$work/bin/as"
}

# The compiler with the flags that all files get.
compile() { # COMPILER SCALAR ARGUMENT...
    compiler_now=$1 scalar_now=$2 assembler=
    shift 2
    case $compiler_now in clang*) assembler="-fno-integrated-as -B$work/bin" ;; esac
    # shellcheck disable=SC2086 # words wanted
    quietly "$compiler_now" $flags $assembler -march=haswell -std=c99 -Wno-psabi -DRBD_REAL="$scalar_now" \
        -I"$work" "$@"
}

# The tables of library.c for what rbd-codegen writes, as objects; sets $special to them.
# Without rbd-codegen there are none.
compile_generated() { # COMPILER
    [ -x "$codegen" ] || return 0
    special=-DGENERATED_LIBRARIES
    for robot in iiwa hyq atlas; do
        for lanes in 1 4; do
            progress "$1: compiling the generated code of $robot"
            name=${robot}_code root= option=
            [ $lanes = 1 ] || name=${name}_lanes option="--lanes $lanes"
            [ $robot = iiwa ] || root=--floating
            upper=$(echo "$name" | tr '[:lower:]' '[:upper:]')
            # shellcheck disable=SC2086 # words wanted
            quietly "$codegen" --name "$name" --output "$work" --algorithm id,mm,mm_packed,fd --gravity-argument \
                $option $root "$bench/../models/$robot.urdf"
            compile "$1" double -c "$work/${name}_code.c" -o "$work/${name}_code.o"
            compile "$1" double -DLIBRARY="library_$name" -DCODE="$name" -DCODE_ROBOT="\"$robot\"" \
                -DCODE_HEADER="\"${name}_code.h\"" -DCODE_LANES=$lanes -DCODE_REAL=double -DCODE_FIXED=false \
                -DCODE_NQ="${upper}_NQ" -DCODE_NV="${upper}_NV" -c "$bench/calls/library.c" -o "$work/$name.o"
            special="$special $work/$name.o $work/${name}_code.o"
        done
    done
}

# count COMPILER SCALAR: one run of callgrind, which leaves its parts, cell after cell, in $work/parts
count() {
    case $2 in double) lanes=4 ;; float) lanes=8 ;; esac # of AVX2
    special=
    [ "$2" = float ] || compile_generated "$1"
    progress "$1, $2: compiling"
    compile "$1" "$2" -DLIBRARY=library_lanes -DRBD_LANES="$lanes" -c "$bench/calls/library.c" -o "$work/lanes.o"
    compile "$1" "$2" -DLIBRARY=library_plain -c "$bench/calls/library.c" -o "$work/plain.o"
    # shellcheck disable=SC2086 # words wanted
    compile "$1" "$2" -DPLAIN_LIBRARY=library_plain -DLANES_LIBRARY=library_lanes $special \
        "$bench/counters/instructions.c" "$work/plain.o" "$work/lanes.o" -lm -o "$work/count"
    progress "$1, $2: counting"
    quietly valgrind --command-line-only=yes --tool=callgrind --cache-sim=yes --collect-atstart=no \
        --combine-dumps=yes --callgrind-out-file="$work/parts" "$work/count"
}

# rows COMPILER_TITLE SCALAR: the parts as CSV; events beyond the last that is not 0 are left out there.
rows() {
    awk -v compiler="$1" -v scalar="$2" '
        /^desc: Trigger: / { requested = sub(/^desc: Trigger: Client Request: /, ""); split($0, cell, ",") }
        /^events: / { for (i = 2; i <= NF; i++) column[$i] = i }
        /^summary: / && requested {
            printf "%s,%s,%s,%s,%.0f,%.0f,%.0f,%s\n", compiler, cell[1], cell[2], scalar,
                $column["Ir"] / cell[3], $column["Dr"] / cell[3], $column["Dw"] / cell[3], cell[4]
        }' "$work/parts"
}

count_all() {
    # All counts are of one library, even if it is being edited.
    cp "$bench/../rbd.h" "$bench/../rbd_derivatives.h" "$bench/../rbd_constraints.h" "$bench/../rbd_batch.h" "$work" || exit 1
    echo "$header" >"$work/counts.csv"
    for compiler in $compilers; do
        for scalar in double float; do
            count "$compiler" "$scalar"
            rows "$(compiler_title "$compiler")" "$scalar" >"$work/rows"
            [ -s "$work/rows" ] || die "callgrind counted nothing"
            cat "$work/rows" >>"$work/counts.csv"
        done
    done
    progress
}

# ---- report ----

# table ACCEPTED COUNTS
table() {
    comparison="change against bench/instructions.csv"
    [ "$1" != /dev/null ] || comparison="nothing to compare with"
    echo "per call; $flags -march=haswell -std=c99; $comparison"
    awk -F , '
        function change(i) {
            if (!(($1, $2, $3, $4, $8, i) in old)) return ""
            was = old[$1, $2, $3, $4, $8, i]
            return $i == was ? "=" : was == 0 ? "new" : sprintf("%+.1f%%", 100 * ($i - was) / was)
        }
        $5 == "instructions" { next }
        FILENAME == ARGV[1] { for (i = 5; i <= 7; i++) old[$1, $2, $3, $4, $8, i] = $i; next }
        $1 != compiler || $4 != scalar {
            printf "\n%-33s %12s %16s %16s\n", $1 ", " $4, "instructions", "loads", "stores"
            robot = ""
        }
        {
            printf "%-7s %-12s %-12s %12d %7s %8d %7s %8d %7s\n", $2 == robot ? "" : $2,
                $2 == robot && $8 == variant ? "" : $8, $3, $5, change(5), $6, change(6), $7, change(7)
            compiler = $1; scalar = $4; robot = $2; variant = $8
        }' "$1" "$2" | sed 's/ *$//'
}

report() {
    case $format in
    table) table "$accepted_now" "$work/counts.csv" ;;
    csv) cat "$work/counts.csv" ;;
    esac
}

# The accepted table is there wholly or not at all: moved into its place.
accept_counts() {
    { cp "$work/counts.csv" "$accepted.$$" && mv "$accepted.$$" "$accepted"; } || die "cannot write $accepted"
    say "instructions: accepted, in $accepted"
}

# ---- the course ----

[ -d "${1-}" ] || usage_error "the first argument is the directory to work in"
work=$1/instructions.$$ codegen=$1/tools/rbd-codegen
shift
read_options "$@"
find_compilers
have valgrind || die "valgrind is not installed"
find_accepted
trap 'rm -rf "$work"' EXIT
trap 'progress; exit 130' INT TERM HUP
mkdir -p "$work" || exit 1
make_assembler
count_all
report
[ "$accept" = no ] || accept_counts
