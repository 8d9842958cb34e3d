#!/usr/bin/env bash
# Compares two programs: runs each line of tests/same_results.txt with OLD and with NEW on this machine, and compares
# all files that they write, byte for byte.
#   bash tests/same_results.sh OLD NEW [NAME...]     programs, e.g. of two build folders; names: only these lines
# Lines with scans are skipped, with a message, where PALPATE_MODELS (default ../shared/models) lacks them. The exit
# code is 1 if a line differs, or fails, that the list does not say to differ.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 2 ] || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
old=$(realpath "$1") new=$(realpath "$2")
shift 2
list=$PWD/tests/same_results.txt
models=$(realpath -m "${PALPATE_MODELS:-../shared/models}")
export PALPATE_GPU=${PALPATE_GPU:-llvmpipe}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/in"

run() {  # PROGRAM FOLDER COMMANDS: arguments of the program, separated by ';'
  local commands=${3//\{M\}/$models} each words
  commands=${commands//\{I\}/$work/in}
  mkdir -p "$2"
  while IFS= read -r each; do
    read -ra words <<< "$each"
    (cd "$2" && timeout 600 "$1" "${words[@]}" --quiet > said.txt 2>&1) ||
      { sed "s|^|  $1: |" "$2/said.txt" | tail -n 3; return 1; }
  done <<< "${commands//;/$'\n'}"
  rm -f "$2/said.txt"  # times, and paths
}

same=0 skipped=0 intended=0 wrong=()
while IFS= read -r line; do
  [[ $line =~ ^(input|trace|conversion|picture|log)\ ([a-z0-9-]+):\ (.*)$ ]] || continue
  kind=${BASH_REMATCH[1]} name=${BASH_REMATCH[2]} commands=${BASH_REMATCH[3]}
  if [ "$kind" = input ]; then
    run "$old" "$work/in" "$commands" || { echo "same_results.sh: $old cannot make $name" >&2; exit 1; }
    continue
  fi
  [ $# -eq 0 ] || [[ " $* " == *" $name "* ]] || continue
  scan=$({ grep -o '{M}/[^ ]*' || true; } <<< "$commands")
  scan=${scan/\{M\}/$models}
  if [ -n "$scan" ] && [ ! -e "$scan" ]; then
    echo "skipped: $kind $name: no $scan"
    skipped=$((skipped + 1))
    continue
  fi
  reason=$(sed -n "s/^differs $name: //p" "$list")
  reason=${reason//$'\n'/; }
  at=$work/$name result=same
  if run "$old" "$at/old" "$commands" && run "$new" "$at/new" "$commands"; then
    [ -n "$(ls -A "$at/old")" ] || result='DIFFERS: writes nothing'
    diff -rq "$at/old" "$at/new" > "$at/diff" ||
      result="DIFFERS: $(sed "s|$at/||g" "$at/diff" | tr '\n' ';')"
  else
    result='FAILED'
  fi
  case $result in
    same) same=$((same + 1)) ;;
    DIFFERS* | FAILED)
      if [ -n "$reason" ]; then
        intended=$((intended + 1)) result="differs by intent: $reason"
      else
        wrong+=("$name")
      fi ;;
  esac
  printf '%-11s %-16s %s\n' "$kind" "$name" "$result"
  rm -rf "$at"
done < "$list"
[ $# -eq 0 ] || [ $((same + skipped + intended + ${#wrong[@]})) -ge $# ] ||
  { echo "same_results.sh: no line has one of these names: $*" >&2; exit 2; }
echo "same_results.sh: $same same, $intended differ by intent, ${#wrong[@]} wrong, $skipped skipped ${wrong[*]}"
[ ${#wrong[@]} -eq 0 ]
