#!/usr/bin/env bash
# Records an animation of the window, without a display:
#   bash apps/film.sh SCENE OUT.gif [SECONDS [SCRIPT]]
# SCENE is an argument of `palpate view`; SCRIPT contains script lines that run meanwhile (apps/view/README.md).
set -euo pipefail
usage() { sed -n '3,4s/^# *//p' "$0" >&2; exit 2; }
[ $# -ge 2 ] && [ $# -le 4 ] || usage
scene=$1 out=$2 seconds=${3:-3} script=${4:-}
palpate=${PALPATE:-$(dirname "$0")/../build/release/palpate}
[ -x "$palpate" ] || {
  echo "film.sh: $palpate does not exist; build the preset release, or set PALPATE to a program" >&2
  exit 1
}
[ -z "$script" ] || [ -r "$script" ] || { echo "film.sh: $script cannot be read" >&2; exit 1; }

frames=$(mktemp -d)
trap 'rm -rf "$frames"' EXIT
{
  [ -z "$script" ] || cat "$script"
  # One picture takes 0.05 s of the script's clock.
  awk -v seconds="$seconds" -v folder="$frames" 'BEGIN {
    for (k = 0; k < seconds * 20; ++k) printf "%.2f screenshot %s/%05d.png\n", 0.3 + k / 20, folder, k
    printf "%.2f quit\n", 0.3 + seconds
  }'
} | sort -s -n -k1,1 > "$frames/script.txt"
xvfb-run -a "$palpate" view "$scene" --script "$frames/script.txt" --size 560x360 >&2
/usr/bin/python3 - "$frames" "$out" <<'PYTHON'
import os
import pathlib
import sys

from PIL import Image

folder, out = sys.argv[1:]
pictures = [Image.open(file).convert("RGB") for file in sorted(pathlib.Path(folder).glob("*.png"))]
colours = pictures[len(pictures) // 2].quantize(96)  # one palette for all, so that static parts do not flicker
frames = [picture.quantize(palette=colours, dither=Image.Dither.NONE) for picture in pictures]
part = f"{out}.part"
frames[0].save(part, format="GIF", save_all=True, append_images=frames[1:], duration=50, loop=0, optimize=True)
os.replace(part, out)
print(f"{out}: {len(frames)} pictures")
PYTHON
