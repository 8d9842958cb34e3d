#!/usr/bin/env bash
# Applies small deliberate bugs (tests/mutations/NN-room-what.patch) one by one, builds the test that each patch names
# and runs it: it must fail. A table at the end lists each bug as killed or survived. The exit code is 1 if more than
# three bugs survive the quick tier, or one survives the full tier, or a patch must be made again.
#   bash tests/mutations.sh [--tier quick|full] [--survivors] [--here] [NN...]
# --tier full also runs named cases of the full tier (PALPATE_TESTS_TIER=full). --survivors runs the whole tier
# (tests/run.sh, or tests/run.sh --full) on each bug that its named case does not detect. All runs use a git worktree of
# HEAD, build/mutations, which keeps its build; uncommitted changes are not in it, except for the patches. --here uses
# this tree and its build instead, which saves a second build; it requires that all changes are committed.
#
# The header of a patch has three lines before the diff:
#   Mutation: one sentence that describes the bug
#   File: the test file, e.g. tests/edit/history_test.cpp or tests/python/test_sessions.py
#   Case: the exact name of a case of doctest (with a * at its end for the cases of a template), or of a function of
#         pytest
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${PALPATE_MUTATIONS_PRESET:-release}  # of the quick tier
limit_s=300                              # of one case; a bug that makes it hang counts as killed
export PALPATE_GPU=${PALPATE_GPU:-llvmpipe} PALPATE_TESTS_VALIDATE=${PALPATE_TESTS_VALIDATE:-core}

tier=quick survivors=no here=no numbers=()
while [ $# -gt 0 ]; do
  case $1 in
    --tier) tier=${2:-}; shift ;;
    --survivors) survivors=yes ;;
    --here) here=yes ;;
    [0-9][0-9] | [0-9][0-9][0-9]) numbers+=("$1") ;;
    *) echo "mutations.sh: '$1' is not an option or a number (see the head of this file)" >&2; exit 2 ;;
  esac
  shift
done
[[ $tier =~ ^(quick|full)$ ]] || { echo "mutations.sh: --tier requires quick or full" >&2; exit 2; }
[ "$tier" = quick ] || export PALPATE_TESTS_TIER=full

patches=()
for patch in tests/mutations/[0-9]*-*.patch; do
  number=$(basename "$patch" | cut -d - -f 1)
  [ ${#numbers[@]} -gt 0 ] && [[ " ${numbers[*]} " != *" $number "* ]] || patches+=("$PWD/$patch")
done
[ ${#patches[@]} -gt 0 ] || { echo "mutations.sh: no patch in tests/mutations has such a number" >&2; exit 2; }

copy=$PWD/build/mutations log=$PWD/build/mutations.log
if [ $here = yes ]; then
  copy=$PWD
  # After each bug all files are restored to HEAD.
  [ -z "$(git status --porcelain --untracked-files=no)" ] ||
    { echo "mutations.sh: --here requires that all changes are committed" >&2; exit 2; }
else
  git worktree prune
  if [ -e "$copy/.git" ]; then
    git -C "$copy" checkout -q -f --detach "$(git rev-parse HEAD)"
  else
    git worktree add -q -f --detach "$copy" HEAD
  fi
fi
built=$copy/build/$preset
cd "$copy"
build() { cmake --build --preset "$preset" --target "$@" > "$log" 2>&1; }

# However this ends, neither a mutated source nor a program built from one is left behind.
mutated=()  # targets that were built with a bug
restore() {
  git -C "$copy" checkout -q -f
  [ ${#mutated[@]} -eq 0 ] || build "${mutated[@]}" ||
    { echo "mutations.sh: $built contains mutated programs: ${mutated[*]} do not build; see $log" >&2; exit 1; }
}
trap restore EXIT
cmake --preset "$preset" > /dev/null

field() { sed -n "s/^$2: //p;/^---/q" "$1"; }  # PATCH NAME

# The target of a test file, which is compiled alone or with others (UNITY_BUILD); empty if it is not built. Of a file
# whose cases run on both back ends it is that of the CPU, unless the bug is in a shader or its header says "On: GPU".
target_of() {  # FILE PATCH
  if [[ $1 == tests/python/* ]]; then
    sed -n 's/^build \(palpate_python\):.*/\1/p' "$built/build.ninja"
    return
  fi
  local part=${1#tests/}
  { sed -n "s|^build tests/CMakeFiles/\([a-z_]*\)\.dir/$part\.o:.*|\1|p" "$built/build.ninja"
    { grep -rl "/$1\"" "$built"/tests/CMakeFiles/*.dir/Unity 2> /dev/null || true; } |
      sed 's|.*/CMakeFiles/\([a-z_]*\)\.dir/.*|\1|'; } | sort -u |
    if grep -qE '^(--- a/shaders/|On: GPU$)' "$2"; then tail -n 1; else head -n 1; fi
}

# Runs a case and returns its failure; 3 if the case does not exist.
run_case() {  # FILE CASE PATCH
  local code=0
  [ -n "$(target_of "$1" "$3")" ] || return 3
  if [[ $1 == tests/python/* ]]; then
    local python
    python=$(sed -n 's/^_Python3_EXECUTABLE:INTERNAL=//p' "$built/CMakeCache.txt")  # the module's Python
    PYTHONPATH=$built/python PYTHONDONTWRITEBYTECODE=1 timeout "$limit_s" \
      "$python" -m pytest -q -p no:cacheprovider "$1::$2" > "$log" 2>&1 || code=$?
    [ $code -ne 4 ] && [ $code -ne 5 ] || return 3
    return $code
  fi
  # A comma separates names.
  timeout "$limit_s" "$built/$(target_of "$1" "$3")" --source-file="*/$1" --test-case="${2//,/?}" > "$log" 2>&1 ||
    code=$?
  ! grep -q '^\[doctest\] test cases: *0 |' "$log" || return 3
  return $code
}

# Each test first runs without its bug: a test that fails anyway kills nothing.
declare -A unmutated
targets=()
for patch in "${patches[@]}"; do
  target=$(target_of "$(field "$patch" File)" "$patch") || true
  [ -z "$target" ] || [[ " ${targets[*]} " == *" $target "* ]] || targets+=("$target")
done
echo "mutations.sh: ${#patches[@]} bugs, $tier tier, at $(git rev-parse --short HEAD); building ${targets[*]}"
build "${targets[@]}" || { tail -n 30 "$log"; echo "mutations.sh: the tests do not build" >&2; exit 1; }
for patch in "${patches[@]}"; do
  code=0
  run_case "$(field "$patch" File)" "$(field "$patch" Case)" "$patch" || code=$?
  unmutated[$patch]=$code
done

outcome() {  # PATCH
  local file name code=0 whole=
  file=$(field "$1" File) name=$(field "$1" Case)
  case ${unmutated[$1]} in
    0) ;;
    3) echo "NO SUCH CASE in the $tier tier: $file: $name"; return ;;
    *) echo "FAILS WITHOUT IT: $file: $name"; return ;;
  esac
  git apply "$1" 2> "$log" || { echo 'DOES NOT APPLY: make the patch again'; return; }
  build "$(target_of "$file" "$1")" || { echo 'DOES NOT BUILD: make the patch again'; return; }
  run_case "$file" "$name" "$1" || code=$?
  [ $code -ne 0 ] && { echo "killed by $file: $name"; return; }
  [ $survivors = no ] || { [ "$tier" = quick ] || whole=--full; bash tests/run.sh $whole > "$log" 2>&1 || code=$?; }
  [ $code -ne 0 ] && { echo "killed by run.sh $whole: $(tail -n 1 "$log")"; return; }
  echo "SURVIVED $file: $name"
}

table=() survived=0 broken=0
for patch in "${patches[@]}"; do
  begin=$SECONDS
  target=$(target_of "$(field "$patch" File)" "$patch") || true
  [ -z "$target" ] || mutated+=("$target")
  result=$(outcome "$patch")
  git checkout -q -f
  case $result in killed*) ;; SURVIVED*) survived=$((survived + 1)) ;; *) broken=$((broken + 1)) ;; esac
  table+=("$(basename "$patch" | cut -d - -f 1)|$(field "$patch" Mutation)|$result|$((SECONDS - begin))")
  printf '%s %4d s  %s\n' "$(basename "$patch" .patch)" $((SECONDS - begin)) "$result"
done

echo
printf '| %-2s | %s | %s | %s |\n' 'Nr' 'Mutation' "Outcome" 'Seconds to build and run'
printf -- '|---|---|---|---|\n'
for row in "${table[@]}"; do printf '| %s |\n' "${row//|/ | }"; done
most=3
[ "$tier" = quick ] || most=0
echo "mutations.sh: ${#patches[@]} bugs: $((${#patches[@]} - survived - broken)) killed, $survived survived," \
  "$broken patches to be made again"
[ $survived -le $most ] && [ $broken -eq 0 ]
