#!/usr/bin/env bash
# Four states of the window in one picture, without a display, as shown in the READMEs:
#   bash apps/window.sh OUT.png
set -euo pipefail
[ $# -eq 1 ] || { sed -n '3s/^# *//p' "$0" >&2; exit 2; }
out=$1
palpate=${PALPATE:-$(dirname "$0")/../build/release/palpate}
[ -x "$palpate" ] || {
  echo "window.sh: there is no $palpate; build the preset release, or name a program in PALPATE" >&2
  exit 1
}

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$palpate" --quiet make sculpture -n 100000 -o "$folder/sculpture.ply"
# The stylus presses; a dent and two hollows; two painted strokes; triangles.
sed "s#%#$folder#" > "$folder/script.txt" <<'SCRIPT'
0.05 mouse 330 335
0.15 key space down
0.25 button left down
0.8 screenshot %/1.png
0.85 button left up
0.85 key 2
0.95 button left down
1.25 button left up
1.3 key 3
1.35 mouse 259 310
1.45 button left down
1.7 button left up
1.75 mouse 255 400
1.85 button left down
2.1 button left up
2.15 key space up
2.3 screenshot %/2.png
2.35 key 7
2.4 mouse 337 170
2.45 key space down
2.55 button left down
2.7 mouse 344 190
2.85 mouse 354 212
3.0 mouse 364 225
3.1 button left up
3.15 mouse 235 425
3.25 button left down
3.4 mouse 250 440
3.55 mouse 270 452
3.7 button left up
3.75 key space up
3.9 screenshot %/3.png
3.95 key m
4.6 screenshot %/4.png
4.7 quit
SCRIPT
XDG_STATE_HOME=$folder xvfb-run -a "$palpate" view "$folder/sculpture.ply" --size 960x540 \
  --script "$folder/script.txt" >&2
/usr/bin/python3 - "$folder" "$out" <<'PYTHON'
import os
import pathlib
import sys

from PIL import Image

folder, out = sys.argv[1:]
width, height = 640, 360
all_four = Image.new("RGB", (2 * width, 2 * height))
for k in range(4):
    state = Image.open(pathlib.Path(folder) / f"{k + 1}.png").convert("RGB").resize((width, height), Image.LANCZOS)
    all_four.paste(state, (width * (k % 2), height * (k // 2)))
part = f"{out}.part"
all_four.save(part, format="PNG", optimize=True)
os.replace(part, out)
PYTHON
