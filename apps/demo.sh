#!/usr/bin/env bash
# Touches a model, sculpts it while it is felt, and draws it, without a window:
#   bash apps/demo.sh [MODEL.ply]        without a model: the built-in sculpture
# Installs missing packages, builds the release, and writes to out/ (beside README.md): touch.png, before.png,
# trace.csv, forces.png, sculpted.ply. The model's path is relative to the current folder.
set -euo pipefail

case "${1:-}" in -h | --help) sed -n '2,5s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
if [ $# -gt 1 ]; then echo "demo.sh: one model at most" >&2; exit 2; fi
model=${1:+$(realpath "$1")}
if [ -n "$model" ] && [ ! -f "$model" ]; then echo "demo.sh: $1: no such file" >&2; exit 1; fi

cd "$(dirname "$0")/.."
steps=6 step=0
say() { step=$((step + 1)); echo; echo "[$step/$steps] $*"; }

say "Installing the packages that are missing"
bash third_party/install.sh
say "Building the release (the first time takes minutes; the numbers in front count the files)"
cmake --preset release > /dev/null
cmake --build --preset release

palpate=build/release/palpate
mkdir -p out
if [ -z "$model" ]; then
  model=out/sculpture.ply
  [ -f "$model" ] || "$palpate" make sculpture -o "$model"
fi

say "Drawing $model before sculpting: out/before.png"
"$palpate" render "$model" -o out/before.png
say "Touching it and pushing a dent into it: out/touch.png, out/trace.csv, out/sculpted.ply"
"$palpate" touch "$model" --path builtin:press --penetration 5 \
  --edit push --yield-depth 1 --push-rate 0.1 --brush-radius 8 \
  --picture out/touch.png --trace out/trace.csv --save out/sculpted.ply
say "Plotting the forces: out/forces.png"
/usr/bin/python3 apps/bench/plot_forces.py out/trace.csv out/forces.png
say "Done; the results are in $PWD/out. build/release/palpate $model opens the window."
