#!/bin/sh
# Builds the playground: OUT/index.html, which holds all, and OUT/LICENCES.txt. Needs what web/wasm/tools.sh needs
# (`./run deps web`), node and npm, which fetches the packages of package-lock.json into node_modules/.
# usage: build.sh OUT [WORK]   WORK keeps what is built on the way: build/web. RBD_HOME: the page that its title leads to
set -eu

usage='usage: build.sh OUT [WORK]'
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
root=$(dirname "$(dirname "$here")")
mkdir -p "${1:?$usage}" "${2-$root/build/web}"
out=$(CDPATH='' cd -- "$1" && pwd)
work=$(CDPATH='' cd -- "${2-$root/build/web}" && pwd)

sh "$root/web/wasm/tools.sh" "$work"
objects=$work/build/objects-Oz

clang-19 --target=wasm32-wasi -O3 -msimd128 -std=c99 -Wall -Wextra -Wconversion -Werror -I"$root" \
    -c "$here/module.c" -o "$work/module.o"
# shellcheck disable=SC2046 # words wanted
clang++-19 --target=wasm32-wasi -mexec-model=reactor -fwasm-exceptions \
    -Wl,--export-dynamic,--strip-all,-z,stack-size=1048576 -o "$work/playground.wasm" "$work/module.o" \
    -Wl,--start-lib $(find "$objects" -name '*.o') -Wl,--end-lib

# The licences of what the modules hold beside rbd; texts of LLVM's libraries and wasi-libc as Debian ships them.
{
    for source in urdfdom tinyxml console-bridge; do
        printf '\n==== %s (in the WebAssembly modules)\n\n' "$source"
        cat "$work/build/urdfdom/$source/debian/copyright"
    done
    for package in libc++-19-dev-wasm32 wasi-libc; do
        printf '\n==== %s (in the WebAssembly modules)\n\n' "$package"
        cat "/usr/share/doc/$package/copyright"
    done
} >"$work/licences.txt"

cd "$here"
if ! cmp -s package-lock.json node_modules/.lock; then
    npm ci --no-audit --no-fund --silent --ignore-scripts || {
        ! npm ping >/dev/null 2>&1 || exit 1 # the registry is there: what failed is ours
        echo "skipped: npm could not fetch its packages" >&2
        exit 77
    }
    cp package-lock.json node_modules/.lock
fi
node bundle.mjs "$work" "$out"
