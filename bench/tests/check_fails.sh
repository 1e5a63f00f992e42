#!/bin/sh
# A command fails as it should: with this exit status, and a message on stderr that has this text.
# usage: check_fails.sh STATUS TEXT COMMAND [ARGUMENT...]
set -u

expected=$1 text=$2
shift 2
message=$("$@" 2>&1 >/dev/null)
status=$?
[ "$status" -eq "$expected" ] || { echo "exit status $status, not $expected: $message"; exit 1; }
case $message in
*"$text"*) ;;
*) echo "the message lacks '$text': $message"; exit 1 ;;
esac
