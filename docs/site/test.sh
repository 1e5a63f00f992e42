#!/bin/sh
# The site: each public declaration has a page, no page or table names what is not there, all links lead somewhere, and
# Sphinx builds it without a warning. Programs of the guides do what is said.
# usage: test.sh names | pages | guides | generated CODEGEN | gpu CODEGEN   pages is skipped (77) without Sphinx, and without
# RBD_ALL_TESTS=yes Sphinx reads the pages and follows their references, but writes none; generated, gpu: the guides whose programs
# need rbd-codegen
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
# PAGE ARGUMENT...: the program in a guide compiles as shown, with these arguments, and prints what is shown.
program_of() {
    page=$1
    shift
    awk '$0 == "```c" { inside = 1; next } inside && /^```/ { exit } inside' "docs/$page.md" >"$scratch/$page.c"
    awk '$0 == "```text" { inside = 1; next } inside && /^```/ { exit } inside' "docs/$page.md" >"$scratch/expected"
    [ -s "$scratch/$page.c" ] && [ -s "$scratch/expected" ]
    # shellcheck disable=SC2086 # CC may be "ccache cc"
    ${CC:-cc} -std=c99 -Dalways_inline=unused -Wall -Wextra -pedantic -Werror -I. "$scratch/$page.c" "$@" -o "$scratch/program" -lm
    "$scratch/program" >"$scratch/printed"
    diff "$scratch/expected" "$scratch/printed"
}

case ${1-} in
names)
    python3 -B "$here/pages.py" --check
    python3 -B "$here/draw.py"
    # The playground's module, which a browser's compiler sees with `--all` alone, fits the headers as they are.
    ${CC:-cc} -std=c99 -fsyntax-only -Wall -Wextra -Wconversion -Werror "-I$here/../.." "$here/../../web/playground/module.c"
    ;;
pages)
    /usr/bin/python3 -c 'import sphinx, furo, myst_parser, numpy' && [ -f /usr/share/javascript/katex/katex.min.js ] ||
        { echo "Sphinx, furo, MyST, numpy or KaTeX is not installed"; exit 77; }
    export PYTHONDONTWRITEBYTECODE=1 RBD_PLAYGROUND=no RBD_COLOURS=no
    if [ -z "${RBD_ALL_TESTS-}" ]; then
        "$here/build.sh" --check -W --keep-going
        echo "SKIPPED but by ./run test --all: links and places of the built pages, the search, the theme"
        exit
    fi
    "$here/build.sh" "$scratch/site" -W --keep-going
    python3 -B "$here/links.py" "$scratch/site"
    python3 -B "$here/anchors.py" "$scratch/site"
    ! command -v node >/dev/null || node "$here/search_test.js" "$scratch/site/_static/search_index.js"
    # Nothing is asked of a server by the theme, its script is no module, and it has dark colours.
    cd "$scratch/site/_static"
    if grep -n 'url(/' styles/*.css || grep -n '^import ' scripts/furo.js; then exit 1; fi
    grep -q 'prefers-color-scheme: dark.*body:not' styles/furo.css
    ;;
guides) # their programs compile as shown and print what is shown
    cd "$here/../.."
    for page in first_minutes gradients predictive_control contacts inverse_kinematics qp tasks other_libraries gravity_compensation computed_torque floating_base; do program_of $page; done
    ;;
generated)
    codegen=$(realpath "$2")
    cd "$here/../.."
    "$codegen" models/iiwa.urdf --name robot --algorithm id,mm,fd --output "$scratch"
    program_of generated_code "-I$scratch" "$scratch/robot_code.c"
    ;;
gpu) # the C++ of the guide to GPUs, as a C++ compiler sees it: kernels are loops, launches are calls
    codegen=$(realpath "$2")
    cd "$here/../.."
    "$codegen" models/iiwa.urdf --name robot --cuda --scalar float --algorithm fd --output "$scratch"
    for number in 1 2 3 4; do
        awk -v wanted=$number '$0 == "```cpp" { inside = ++number == wanted; next } /^```/ { inside = 0 } inside' docs/gpu.md |
            sed 's/<<<.*>>>//' >"$scratch/guide_$number.h"
        [ -s "$scratch/guide_$number.h" ]
    done
    # shellcheck disable=SC2086 # CXX may be "ccache c++"
    ${CXX:-c++} -std=c++11 -O0 -Dalways_inline=unused -Wall -Wextra -Werror -Wno-unused-parameter -I. -I"$scratch" \
        docs/site/gpu_guide.cpp -o "$scratch/program"
    "$scratch/program"
    ;;
*) exit 2 ;;
esac
