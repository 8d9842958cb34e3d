#!/usr/bin/env bash
# Reads the docstrings of the Python package with Sphinx, which fails on a warning, such as of a public name that the
# reference lacks. Exit code 77: Sphinx is not installed.
#   tests/python/reference.sh PYTHON FOLDER
set -euo pipefail
[ -z "${PALPATE_TESTS_ONLY:-}" ] || { echo "reference.sh: skipped: it has no label $PALPATE_TESTS_ONLY"; exit 77; }
"$1" -c 'import sphinx' 2> /dev/null || { echo "reference.sh: skipped: python3-sphinx is not installed"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cp -r "$(dirname "$0")/../../apps/python/reference" "$scratch/sources"

fail() { echo "reference.sh: $*" >&2; exit 1; }
check() { PYTHONPATH=$2 "$1" -m sphinx -W --keep-going -q -b dummy "$scratch/sources" "$scratch/read"; }

check "$@"
sed -i '/autofunction:: gpus/d; s/Session.touch/Session.feel/' "$scratch/sources/index.rst"
if check "$@" 2> "$scratch/found.txt"; then fail 'a missing name is not detected'; fi
for each in 'palpate.gpus is missing in index.rst' 'reference target not found: Session.feel'; do
  grep -q "$each" "$scratch/found.txt" || fail "not detected: $each: $(cat "$scratch/found.txt")"
done
