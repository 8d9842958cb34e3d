#!/usr/bin/env bash
# wine.sh PROGRAM ARGUMENTS...: runs a Windows program. Wine's background processes remain for some seconds and would
# keep the caller's pipes open, so output goes through a file.
set -u
export WINEPREFIX=${WINEPREFIX:-$(dirname "$(readlink -f "$0")")/../build/windows-libraries/wine}
export WINEDEBUG=${WINEDEBUG:--all} LC_ALL=C.UTF-8  # in UTF-8 file names may contain any letter
# A debugger that starts at a crash would wait forever.
export WINEDLLOVERRIDES="winedbg.exe=d${WINEDLLOVERRIDES:+;$WINEDLLOVERRIDES}"
WINEPREFIX=$(readlink -f "$WINEPREFIX")
output=$(mktemp)
trap 'rm -f "$output"' EXIT
wine "$@" < /dev/null > "$output" 2>&1
code=$?
cat "$output"
exit $code
