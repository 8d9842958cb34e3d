#!/usr/bin/env bash
# Checks the types of the Python package with mypy; exit code 77: mypy is not installed.
#   tests/python/types.sh PYTHON FOLDER
set -euo pipefail
[ -z "${PALPATE_TESTS_ONLY:-}" ] || { echo "types.sh: skipped: it has no label $PALPATE_TESTS_ONLY"; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
"$1" -m mypy --version > /dev/null 2>&1 || { echo "types.sh: skipped: mypy is not installed"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
export MYPYPATH=$2 PYTHONPATH=$2
# Unpack is an experiment for mypy before 1.5.
printf '[mypy]\nenable_incomplete_feature = Unpack\n' > mypy.ini
"$1" -m mypy --strict --cache-dir "$scratch/cache" "$2/palpate" "$here/typed.py"
"$1" -m mypy.stubtest palpate --mypy-config-file mypy.ini --ignore-missing-stub \
  --allowlist "$here/stubtest_allowlist.txt"

# Misspelt words and keywords are refused, on the lines that are marked and on no other.
"$1" -m mypy --strict --cache-dir "$scratch/cache" "$here/mistyped.py" > refused.txt || true
sed -n 's/^.*mistyped.py:\([0-9]*\): error.*/\1/p' refused.txt | sort -nu > found.txt
grep -n '# wrong$' "$here/mistyped.py" | cut -d: -f1 > wanted.txt
if ! diff wanted.txt found.txt; then
  echo "types.sh: mypy refused other lines of mistyped.py than those marked:"
  cat refused.txt
  exit 1
fi
