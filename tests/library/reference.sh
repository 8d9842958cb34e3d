#!/usr/bin/env bash
# Generates the reference of the C and C++ headers, which fails on a warning, such as of a name without a description.
# Exit code 77: doxygen is not installed.
#   tests/library/reference.sh
set -euo pipefail
[ -z "${PALPATE_TESTS_ONLY:-}" ] || { echo "reference.sh: skipped: it has no label $PALPATE_TESTS_ONLY"; exit 77; }
command -v doxygen > /dev/null || { echo "reference.sh: skipped: doxygen is not installed"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cp -r "$(dirname "$0")"/../../haptics/library/{include,reference} "$scratch"
cd "$scratch/reference"

fail() { echo "reference.sh: $*" >&2; exit 1; }

mkdir "$scratch/html"
export PALPATE_REFERENCE=$scratch/html PALPATE_VERSION=0
doxygen
grep -q pp_default_live_state "$scratch/html/group__live.html" || fail 'the reference lacks pp_default_live_state()'

sed -i 's|/\*\*< bytes of this struct \*/||' "$scratch/include/palpate/live.h"
if doxygen 2> "$scratch/found.txt"; then fail 'a struct member without a description is not detected'; fi
grep -q 'size (variable) of struct pp_live_state is not' "$scratch/found.txt" || fail "$(cat "$scratch/found.txt")"
