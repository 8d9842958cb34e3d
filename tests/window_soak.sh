#!/usr/bin/env bash
# Opens one model after another in the window and fails if anything is left behind:
#   tests/window_soak.sh [PROGRAM [CYCLES]]     default: build/asan/palpate 500; needs xvfb
# Small and medium models, binary and text, with and without normals, one that is broken, some dropped while another one
# is being loaded; in between a stroke, undo, resizing, the mesh and back. Fails on an exit code other than 0, on any
# message of AddressSanitizer, its leak check or UBSan (build/asan), on a model that was not opened, and if resident
# memory grows from the third to the fourth quarter by more than 4 MiB and 3 %.
set -euo pipefail

program=$(realpath "${1:-$(dirname "$0")/../build/asan/palpate}")
cycles=${2:-500}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export XDG_STATE_HOME=$folder/state PALPATE_GPU=${PALPATE_GPU:-llvmpipe}
# A small quarantine, so that freed memory is soon reused and resident memory is meaningful.
export ASAN_OPTIONS=detect_leaks=1:quarantine_size_mb=8:malloc_context_size=20${ASAN_OPTIONS:+:$ASAN_OPTIONS}
export UBSAN_OPTIONS=print_stacktrace=1${UBSAN_OPTIONS:+:$UBSAN_OPTIONS}

make() { ASAN_OPTIONS=detect_leaks=0 "$program" --quiet make "$@"; }
bare() {  # FROM TO: the same in text without normals
  awk 'body { print $1, $2, $3; next } /^property .* n[xyz]$/ { next } { print } /^end_header/ { body = 1 }' "$1" > "$2"
}
cd "$folder"
make sphere -n 1000 -o sphere.ply
make torus -n 5000 --ascii -o torus.ply
make cube -n 20000 -o cube.ply
make sculpture -n 50000 -o sculpture.ply
make bumpy-sphere -n 10000 --ascii -o with.ply && bare with.ply bumpy.ply
make plane -n 3000 --ascii -o with.ply && bare with.ply plane.ply
head -c 4000 cube.ply > broken.ply
models=(sphere torus cube sculpture bumpy plane)

every=$(((cycles + 49) / 50))  # cycles between memory samples, always with the same model
{
  t=0
  at() { printf '%d.%02d %s\n' $((t / 100)) $((t % 100)) "$1"; }
  for ((i = 1; i <= cycles; ++i)); do
    t=$((t + 10))
    model=${models[$((i * 7 % ${#models[@]}))]}
    if ((i % every == 0)); then model=sphere; fi
    if ((i % 25 == 7)); then at "drop $folder/broken.ply"; fi
    if ((i % 5 == 0)); then  # drops the second model while the first is being loaded
      at impatient
      at "drop $folder/sculpture.ply"
      t=$((t + (i % 4) * 5))
      at "drop $folder/$model.ply"
      at patient
    else
      at "drop $folder/$model.ply"
    fi
    t=$((t + 10))
    if ((i % 10 == 3)); then
      at 'mouse 119 120' && t=$((t + 20))
      at "key $((2 + i / 10 % 6))"
      at 'key space down' && t=$((t + 10))
      at 'button left down' && t=$((t + 60))
      at 'button left up'
      at 'key space up' && t=$((t + 10))
      if ((i % 20 == 3)); then at 'key m'; t=$((t + 10)); fi
      at 'key ctrl+z'
      at 'key 1'
      at "resize $((400 + i % 60)) $((200 + i % 40))" && t=$((t + 10))
    fi
    if ((i % every == 0)); then at "state $folder/cycle-$i.json"; fi
  done
  t=$((t + 10))
  at quit
} > script.txt

# If a driver is unloaded before the leak check, pointers to its memory are lost: lavapipe's list of exit handlers would
# count as a leak. Preloading keeps the driver loaded.
preload=$(ldd "$program" | awk '/libasan/ { print $3 }')
if [ -n "$preload" ]; then
  preload+=$(sed -n 's/.*"library_path": *"\(.*\)".*/:\1/p' /usr/share/vulkan/icd.d/lvp_icd*.json | head -n 1)
fi
cat > start.sh <<'END'
echo $$ > "$1/pid"
if [ -n "$3" ]; then export LD_PRELOAD=$3; fi
exec "$2" --quiet view --size 480x240 --script "$1/script.txt"
END
xvfb-run -a -s '-screen 0 800x600x24' bash start.sh "$folder" "$program" "$preload" > said.txt 2>&1 &
run=$!
samples=()
for ((i = every; i <= cycles; i += every)); do
  while [ ! -e "cycle-$i.json" ] && kill -0 $run 2> /dev/null; do sleep 0.05; done
  [ -e "cycle-$i.json" ] || break
  resident=$(awk '/^VmRSS/ { print int($2 / 1024) }' "/proc/$(cat pid)/status" 2> /dev/null || true)
  [ -n "$resident" ] || break
  samples+=("$resident")
  if ((i % (every * 5) == 0)); then echo "after $i cycles: $resident MiB"; fi
done
code=0
wait $run || code=$?

fail() {
  grep -v '^$' said.txt | tail -n "${PALPATE_SOAK_LINES:-200}" >&2
  echo "window_soak.sh: $1" >&2
  exit 1
}
[ $code -eq 0 ] || fail "the window ended with exit code $code"
if grep -qE 'AddressSanitizer|LeakSanitizer|runtime error:' said.txt; then fail "a sanitizer complained"; fi
for ((i = every; i <= cycles; i += every)); do
  [ -e "cycle-$i.json" ] || fail "cycle $i was not reached"
  grep -q '"model": ".*/sphere.ply"' "cycle-$i.json" \
    || fail "after cycle $i the model is not sphere.ply: $(cat "cycle-$i.json")"
done
count=${#samples[@]}
median() { printf '%s\n' "$@" | sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
third=$(median "${samples[@]:count / 2:(count + 3) / 4}")
last=$(median "${samples[@]:count * 3 / 4}")
margin=$((4 + third * 3 / 100))
echo "$cycles cycles; resident: $third MiB in the third quarter, $last in the fourth"
# One-time allocations occur within the first hundred cycles.
if ((cycles < 100)); then exit 0; fi
((last <= third + margin)) || fail "resident memory grew by $((last - third)) MiB; $margin would be noise"
