#!/usr/bin/env bash
# wine.sh PROGRAM ARGUMENTS...: runs a program for Windows. Wine's own processes stay for some seconds and would hold
# the caller's pipes open for as long, so output goes through a file.
set -u
export WINEPREFIX=${WINEPREFIX:-$(dirname "$(readlink -f "$0")")/../build/windows-libraries/wine}
export WINEDEBUG=${WINEDEBUG:--all} LC_ALL=C.UTF-8  # in which names of files have all letters
# No debugger starts at a crash: it would wait forever.
export WINEDLLOVERRIDES="winedbg.exe=d${WINEDLLOVERRIDES:+;$WINEDLLOVERRIDES}"
WINEPREFIX=$(readlink -f "$WINEPREFIX")
output=$(mktemp)
trap 'rm -f "$output"' EXIT
wine "$@" < /dev/null > "$output" 2>&1
code=$?
cat "$output"
exit $code
