#!/bin/sh
# The playground, and the site with it, built and used in a real browser; skipped where something for it is missing.
# usage: test.sh TOOLS WORK   TOOLS has rbd-model and rbd-codegen; WORK keeps the page and what it is made of
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd) root=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd)

for program in clang-19 wasm-ld-19 node npm chromium; do
    command -v $program >/dev/null || { echo "skipped: there is no $program: ./run deps web browser"; exit 77; }
done
[ -d /usr/include/wasm32-wasi/c++ ] || { echo "skipped: there is no C++ library for wasm32-wasi: ./run deps web browser"; exit 77; }

sh "$here/build.sh" "$2/playground" "$2"
node "$here/test.mjs" "$2/playground/index.html" "$1"

# The site with it, where Sphinx is there too.
if /usr/bin/python3 -c 'import sphinx, furo, myst_parser' 2>/dev/null; then
    RBD_PLAYGROUND=yes sh "$root/docs/site/build.sh" "$2/site"
    node "$root/docs/site/browser.mjs" "$2/site"
fi
