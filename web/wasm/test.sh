#!/bin/sh
# Builds the commands as WebAssembly and compares them with the native ones; skipped where something for it is missing.
# usage: test.sh TOOLS WORK   TOOLS has the native commands; WORK keeps what is built
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
for program in clang-19 wasm-ld-19 node make dpkg-source; do
    command -v $program >/dev/null || { echo "skipped: there is no $program: ./run deps web"; exit 77; }
done
[ -d /usr/include/wasm32-wasi/c++ ] || { echo "skipped: there is no C++ library for wasm32-wasi: ./run deps web"; exit 77; }
sh "$here/tools.sh" "$2"
node "$here/test.mjs" "$2" "$1"
