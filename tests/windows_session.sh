#!/usr/bin/env bash
# Runs one session with the Windows program, under wine on lavapipe, and with the Linux program: forces must be equal up
# to rounding, on the GPU and on the CPU, and a picture is drawn. Requires both programs (presets release and windows).
set -euo pipefail
cd "$(dirname "$0")/.."

# Under Wine the GPU requires a display.
if [ -z "${DISPLAY:-}" ]; then exec xvfb-run -a bash tests/windows_session.sh; fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export LC_ALL=C.UTF-8 PALPATE_GPU=${PALPATE_GPU:-llvmpipe}
linux=$PWD/build/release/palpate windows=(bash "$PWD/third_party/wine.sh" "$PWD/build/windows/palpate.exe")

# Numbers that differ by more than a millionth of the larger one, and by more than a millionth.
differences() {  # FILE FILE
  paste -d '\n' "$1" "$2" | awk -F, '
    NR % 2 { n = split($0, one, ","); next }
    { if (split($0, other, ",") != n) { print "line " NR / 2 ": another number of columns"; exit }
      for (i = 1; i <= n; ++i) {
        if (one[i] == other[i]) continue
        a = one[i] + 0; b = other[i] + 0; d = a > b ? a - b : b - a; m = a < 0 ? -a : a
        if (NR != 2 && d <= 1e-6 * (m > 1 ? m : 1)) continue
        print "line " NR / 2 ", column " i ": " one[i] ", " other[i]
        exit
      } }'
}

cd "$folder"
"${windows[@]}" make sphere -n 20000 -o größe.ply
"$linux" make sphere -n 20000 -o linux.ply
for backend in cpu vulkan; do
  session=(--backend "$backend" --edit push --penetration 2 --duration 1)
  "$linux" touch linux.ply "${session[@]}" --trace linux.csv > linux.txt
  "${windows[@]}" touch größe.ply "${session[@]}" --trace windows.csv --save "$backend.ply" > windows.txt
  differs=$(differences linux.csv windows.csv)
  if [ -n "$differs" ]; then
    echo "windows_session.sh: $backend: what is felt differs, $differs" >&2
    exit 1
  fi
  echo "windows_session.sh: $backend: $(wc -l < windows.csv) rows are the same up to rounding"
done
"${windows[@]}" render vulkan.ply -o picture.png --size 320x240
test -s picture.png
