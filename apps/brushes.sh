#!/usr/bin/env bash
# A ball before, and after the same stroke with each brush (grab: pressed and pulled out), as shown in
# engine/edit/README.md; needs python3-pil and fonts-dejavu-core:
#   bash apps/brushes.sh OUT.png
set -euo pipefail
[ $# -eq 1 ] || { sed -n '4s/^# *//p' "$0" >&2; exit 2; }
out=$1
palpate=${PALPATE:-$(dirname "$0")/../build/release/palpate}
[ -x "$palpate" ] || {
  echo "brushes.sh: there is no $palpate; build the preset release, or name a program in PALPATE" >&2
  exit 1
}

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$palpate" --quiet make bumpy-sphere -n 100000 --noise 0.07 -o "$folder/ball.ply"
# 3 mm deep along a line; and in, then out by 10 mm.
/usr/bin/python3 - "$folder" <<'PYTHON'
import sys


def path(name, keys):
    with open(f"{sys.argv[1]}/{name}.csv", "w") as out:
        out.write("t_s,x,y,z\n")
        for t_s, x, y, depth in keys:
            out.write(f"{t_s:.3f},{x:.3f},{y:.3f},{(48 * 48 - x * x - y * y) ** 0.5 - depth:.4f}\n")


path("slide", [(0, -12, 7, -10)] + [(0.3 + 0.1 * k, -12 + 2 * k, 7 - 7 * k / 6, 3) for k in range(13)])
path("pull", [(0, 0, 0, -10), (0.3, 0, 0, 3), (0.5, 0, 0, 3), (1.3, 3, 3, -10), (1.5, 3, 3, -10)])
PYTHON
camera='eye=25,40,150 target=0,0,46 fov=22'
"$palpate" --quiet render "$folder/ball.ply" --size 315x300 --camera "$camera" -o "$folder/before.png"
brushes="push carve inflate smooth flatten grab paint"
for brush in $brushes; do
  path=slide
  [ $brush = grab ] && path=pull
  "$palpate" --quiet touch "$folder/ball.ply" --backend cpu --mm-per-unit 1 --path "$folder/$path.csv" --edit $brush \
    --strength 1 --size 315x300 --camera "$camera" --picture "$folder/$brush.png" > /dev/null
done
/usr/bin/python3 - "$folder" "$out" before $brushes <<'PYTHON'
import os
import sys

from PIL import Image, ImageDraw, ImageFont

folder, out, *names = sys.argv[1:]
width, height = 315, 300
font = ImageFont.truetype("DejaVuSans.ttf", 16)
page = Image.new("RGB", (4 * width, -(-len(names) // 4) * height))
for k, name in enumerate(names):
    picture = Image.open(f"{folder}/{name}.png").convert("RGB")
    ImageDraw.Draw(picture).text((10, 10), name, fill=(235, 235, 235), font=font)
    page.paste(picture, (width * (k % 4), height * (k // 4)))
part = f"{out}.part"
page.save(part, format="PNG", optimize=True)
os.replace(part, out)
PYTHON
