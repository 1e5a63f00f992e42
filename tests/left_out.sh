#!/bin/sh
# Stands for a test that takes long for what it adds: ./run test --all has it, and tests/meson.build says why.
echo "left out: ./run test --all runs it"
exit 77
