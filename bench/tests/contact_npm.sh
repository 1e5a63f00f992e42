#!/bin/sh
# The scenes in MuJoCo's WebAssembly build, which $MUJOCO_NPM/node_modules has, are right.
# usage: contact_npm.sh CONTACT MUJOCO.MJS      Exit status 77: not there.
set -eu

[ -d "${MUJOCO_NPM:-/nowhere}/node_modules/@mujoco/mujoco" ] || { echo "skipped: no folder MUJOCO_NPM has @mujoco/mujoco"; exit 77; }
command -v node >/dev/null || { echo "skipped: no node"; exit 77; }
rows=$("$1" --results-of "node '$2' '$MUJOCO_NPM'" | grep -c '"[^"]*",MuJoCo [0-9]')
[ "$rows" -eq 64 ] || { echo "$rows rows, not 64: eight scenes, eight settings"; exit 1; }
