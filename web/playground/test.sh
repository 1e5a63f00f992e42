#!/bin/sh
# The playground, built and used in a real browser; skipped where something for it is missing.
# usage: test.sh TOOLS WORK   TOOLS has rbd-model and rbd-codegen; WORK keeps the page and what it is made of
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)

for program in clang-19 wasm-ld-19 node npm chromium; do
    command -v $program >/dev/null || { echo "skipped: there is no $program: ./run deps web browser"; exit 77; }
done
[ -d /usr/include/wasm32-wasi/c++ ] || { echo "skipped: there is no C++ library for wasm32-wasi: ./run deps web browser"; exit 77; }

sh "$here/build.sh" "$2/playground" "$2"
node "$here/test.mjs" "$2/playground/index.html" "$1"
