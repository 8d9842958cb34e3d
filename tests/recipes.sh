#!/usr/bin/env bash
# Follows the recipes of .github/CONTRIBUTING.md: tests/recipes/NAME.patch adds a dummy brush, device or setting by the
# files alone that its row names. Each is applied to HEAD, built, and must pass its commands.
#   bash tests/recipes.sh [--here] [NAME...]      --here: in this tree and its build, with all changes committed
#
# The header of a patch, before the diff:
#   Recipe: the first column of its row
#   Targets: what it builds
#   Run: a command in the tree; each must succeed. $palpate is the program, $tests the folder of the test programs
set -euo pipefail
cd "$(dirname "$0")/.."
copy=$PWD/build/recipes log=$PWD/build/recipes.log
export PALPATE_GPU=${PALPATE_GPU:-llvmpipe} PALPATE_TESTS_VALIDATE=${PALPATE_TESTS_VALIDATE:-core}
fail() { echo "recipes.sh: $*" >&2; exit 1; }
mapfile -t patches < <(printf '%s\n' "$PWD"/tests/recipes/*.patch)
if [ "${1:-}" = --here ]; then
  shift
  copy=$PWD
  [ -z "$(git status --porcelain --untracked-files=no)" ] || fail "--here requires that all changes are committed"
elif [ -e "$copy/.git" ]; then
  git -C "$copy" checkout -q -f --detach "$(git rev-parse HEAD)"
else
  git worktree prune && git worktree add -q -f --detach "$copy" HEAD
fi
[ $# -eq 0 ] || mapfile -t patches < <(printf "$PWD/tests/recipes/%s.patch\n" "$@")
cd "$copy"
export palpate=$PWD/build/release/palpate tests=$PWD/build/release
field() { sed -n "s/^$2: //p;/^diff/q" "$1"; }  # PATCH NAME
applied=
restore() { [ -z "$applied" ] || git apply -R "$applied"; applied=; }
trap restore EXIT
for patch in "${patches[@]}"; do
  row=$(grep -F "| $(field "$patch" Recipe) |" .github/CONTRIBUTING.md) || fail "$patch: CONTRIBUTING has no such row"
  for file in $(git apply --numstat "$patch" | cut -f 3); do
    name=$(basename "$file")
    [[ $name != dummy* ]] || name=NAME${name#dummy} name=${name%.*}
    [[ $row == *"$name"* ]] || fail "$patch: the row does not name $file"
  done
  git apply "$patch" || fail "$patch does not apply: make it again"
  applied=$patch
  { cmake --preset release && cmake --build --preset release --target $(field "$patch" Targets); } > "$log" 2>&1 ||
    { tail -n 30 "$log"; fail "$patch does not build"; }
  while read -r command; do
    bash -euo pipefail -c "$command" > "$log" 2>&1 || { tail -n 30 "$log"; fail "$patch: $command"; }
  done < <(field "$patch" Run)
  restore
  echo "recipes.sh: $(field "$patch" Recipe): $(git apply --numstat "$patch" | wc -l) files"
done
