#!/usr/bin/env bash
# Uses the installer and the zip of `cpack --preset windows` under wine, in folders with spaces and umlauts: the program
# with stand-ins of haptic devices and a window, the library from a program in C; what the installer changed, and what
# remains after the removal. Requires the presets windows (all_tests) and release (haply_service).
set -euo pipefail
cd "$(dirname "$0")/.."
if [ -z "${DISPLAY:-}" ]; then exec xvfb-run -a bash tests/windows_packages.sh; fi

scratch=$(mktemp -d)
export WINEPREFIX=$scratch/wine WINEDLLOVERRIDES='winemenubuilder.exe=d;mscoree=d;mshtml=d' LC_ALL=C.UTF-8
export PALPATE_GPU=${PALPATE_GPU:-llvmpipe}
end() {
  # shellcheck disable=SC2046
  kill $(jobs -p) 2> /dev/null || true
  wineserver -k || true
  rm -rf "$scratch"
}
trap end EXIT
packages=$PWD/build/windows tests=$PWD/tests toolchain=$PWD/third_party/windows_toolchain.cmake
service=$PWD/build/release/haply_service wine=(bash "$PWD/third_party/wine.sh")
fail() { echo "windows_packages.sh: $*" >&2; exit 1; }
says() {  # TEXT FILE
  grep -q -F -e "$1" "$2" || fail "'$1' is not in: $(cat "$2")"
}
quietly() { "$@" > "$scratch/said" 2>&1 || fail "$*: $(cat "$scratch/said")"; }
registry() { wineserver -w; cat "$WINEPREFIX/user.reg" "$WINEPREFIX/system.reg"; }
below() { (cd "$1" && find . -type f | sort); }

is_felt() { awk -F '[:,]' '/"peak_force_N"/ { exit !($2 > 0.3) }' "$scratch/touch.json"; }
feels_a_haply() {  # PROGRAM: taps are felt, and the last force is zero
  mkfifo "$scratch/end"
  exec 3<> "$scratch/end"
  rm -f "$scratch/service"
  "$service" < "$scratch/end" > "$scratch/service" 3>&- &
  local number=$! most last
  until [ -s "$scratch/service" ]; do sleep 0.1; done
  export PALPATE_HAPLY_CONFIG
  PALPATE_HAPLY_CONFIG=Z:$(head -n 1 "$scratch/service")
  : > "$(dirname "${PALPATE_HAPLY_CONFIG#Z:}")/taps"
  quietly "$@" doctor --device haply
  says 'serial number   049D' "$scratch/said"
  # On a busy machine wine's clocks stall, which takes the force away, as old states do: there are further tries.
  for _ in 1 2 3 4; do
    quietly "$@" touch "$model" --backend cpu --mm-per-unit 1 --stiffness 0.4 --device haply --realtime --duration 3 \
      --json "$scratch/touch.json"
    ! is_felt || break
  done
  exec 3>&-
  rm "$scratch/end"
  wait "$number"
  unset PALPATE_HAPLY_CONFIG
  read -r most last _ < <(tail -n 1 "$scratch/service")
  awk -v most="$most" -v last="$last" 'BEGIN { exit !(most > 0.3 && last == 0) }' ||
    fail "a Haply device felt at most $most N, and $last N at the end"
}

feels_a_touch() {  # PROGRAM
  printf 't_s,x,y,z\n0,0,40,0\n0.4,0,28.5,0\n0.9,4,28.2,0\n1.2,4,40,0\n' > "$scratch/hand.csv"
  printf 'hurry\nlead 0.5\nhand Z:%s\n' "$scratch/hand.csv" > "$scratch/script"
  PALPATE_HD_LIBRARY=Z:$packages/fake_devices/libfake_hd.dll PALPATE_FAKE_DEVICE=Z:$scratch/script quietly "$@" touch \
    "$model" --backend cpu --mm-per-unit 1 --map identity --device openhaptics --realtime --duration 1.7 \
    --json "$scratch/touch.json"
  is_felt || fail 'a Touch felt nothing'
}

opens_a_window() {  # PROGRAM
  printf '0.3 state Z:%s\n0.4 quit\n' "$scratch/state.json" > "$scratch/window"
  rm -f "$scratch/state.json"
  quietly "$@" view "$model" --size 320x240 --script "Z:$scratch/window"
  grep -q '"points": 20000' "$scratch/state.json" || fail "the window shows no model: $(cat "$scratch/state.json")"
  # Without a driver it says why, and the processor still answers.
  export WINEDLLOVERRIDES="$WINEDLLOVERRIDES;vulkan-1=d"
  if "$@" view "$model" > "$scratch/said" 2>&1; then fail 'a window was opened without Vulkan'; fi
  says 'no Vulkan loader (vulkan-1.dll) was found; install the current driver' "$scratch/said"
  quietly "$@" touch "$model"
  WINEDLLOVERRIDES=${WINEDLLOVERRIDES%;vulkan-1=d}
}

serves_programs() {  # FOLDER: the library exports the C interface alone, needs only Windows, and a program in C feels
  local dll=$1/bin/palpate.dll
  x86_64-w64-mingw32-objdump -p "$dll" > "$scratch/dump"
  diff <(bash "$tests/consumers/declared.sh" "$1/include/palpate") \
    <(sed -n '/Ordinal\/Name Pointer/,/^$/s/^\t*\[ *[0-9]*\] *\(.*\)$/\1/p' "$scratch/dump" | sort) ||
    fail "headers and $dll differ"
  local others
  others=$(sed -n 's/.*DLL Name: //p' "$scratch/dump" | grep -i -E 'gcc|stdc|winpthread|glfw|vulkan' || true)
  [ -z "$others" ] || fail "$dll needs $others"
  quietly cmake -G Ninja -S "$1/share/doc/palpate/examples" -B "$scratch/built" -DCMAKE_TOOLCHAIN_FILE="$toolchain" \
    -Dpalpate_DIR="$1/lib/cmake/palpate"
  quietly cmake --build "$scratch/built"
  export WINEPATH=Z:$1/bin
  quietly "${wine[@]}" "$scratch/built/press.exe"
  awk '!($2 > 0.6 && $2 < 0.9) { exit 1 }' "$scratch/said" || fail "press: $(cat "$scratch/said")"
  cat "$scratch/said"
  awk 'BEGIN {print "x,y,z"; for (i = -60; i <= 60; ++i) for (j = -60; j <= 60; ++j)
    printf "%g,%g,%g\n", i, j, 20 * exp(-(i * i + j * j) / 800)}' > hump.csv
  quietly "${wine[@]}" "$scratch/built/dent.exe" hump.csv dented.ply
  [ "$(head -c 3 dented.ply)" = ply ] || fail 'nothing was saved'
  quietly "${wine[@]}" "$scratch/built/stir.exe"
  unset WINEPATH
  rm -r "$scratch/built"
}

works_in() {  # FOLDER
  local program=("${wine[@]}" "$1/bin/palpate.exe")
  mkdir "$scratch/größe" && cd "$scratch/größe"
  model=modell.ply
  quietly "${program[@]}" make sphere -n 20000 --size 60 -o "$model"
  quietly "${program[@]}" convert "$model" größe.laz
  quietly "${program[@]}" info größe.laz
  "${program[@]}" doctor > "$scratch/said" 2>&1 || true
  for part in llvmpipe '--device haply' '--device openhaptics'; do says "$part" "$scratch/said"; done
  feels_a_haply "${program[@]}"
  feels_a_touch "${program[@]}"
  opens_a_window "${program[@]}"
  serves_programs "$1"
  cd "$scratch" && rm -r größe
}

quietly "${wine[@]}" wineboot
mkdir "$scratch/ein Ördner"
quietly cmake -E chdir "$scratch/ein Ördner" cmake -E tar xf "$packages"/palpate-*-windows-x86_64.zip
works_in "$(echo "$scratch/ein Ördner"/palpate-*)"
[ -z "$(registry | grep -i 'windows-x86_64' | grep -v -i 'microsoft.*recent' || true)" ] || fail 'the zip left settings'

installer=$(echo "$packages"/palpate-*-windows-x86_64.exe)
folder=$WINEPREFIX/drive_c/Möbel\ und\ Töne/palpate
registry > "$scratch/before.reg"
below "$WINEPREFIX/drive_c" > "$scratch/before"
quietly "${wine[@]}" "$installer" /S /PATH /OPEN_WITH '/D=C:\Möbel' und 'Töne\palpate'
[ -x "$folder/bin/palpate.exe" ] || fail "nothing was installed in $folder"
diff <(below "$folder" | grep -v uninstall.exe) <(below "$scratch/ein Ördner"/palpate-*) ||
  fail 'the installer and the zip differ'
registry > "$scratch/installed.reg"
for part in 'T\xf6ne\\palpate\\bin"' 'Applications\\palpate.exe\\SupportedTypes' '".laz"=' 'QuietUninstallString'; do
  says "$part" "$scratch/installed.reg"
done
find "$WINEPREFIX/drive_c/users" -name palpate.lnk | grep -q 'Start Menu/Programs/palpate' || fail 'no Start menu'
works_in "$folder"

# A second installation replaces the first one and keeps its choices, and what the user has put there.
echo mine > "$folder/share/mine.txt"
in_path() { registry | grep -c '^"P[Aa][Tt][Hh]".*T\\xf6ne\\\\palpate\\\\bin"' || true; }
quietly "${wine[@]}" "$installer" /S '/D=C:\Möbel' und 'Töne\palpate'
[ "$(in_path)" = 1 ] || fail 'the search path is not as before'

# Nothing is removed while the program runs.
"${wine[@]}" "$folder/bin/palpate.exe" make sphere -n 20000 -o "Z:$scratch/model.ply"
"${wine[@]}" "$folder/bin/palpate.exe" touch "Z:$scratch/model.ply" --backend cpu --realtime --duration 8 \
  > /dev/null 2>&1 &
running=$!
sleep 4
code=0
"${wine[@]}" "$folder/uninstall.exe" /S '_?=C:\Möbel' und 'Töne\palpate' || code=$?
[ "$code" = 2 ] || fail "a removal while palpate runs ended with $code"
diff <(below "$folder" | grep -v -e uninstall.exe -e mine.txt) <(below "$scratch/ein Ördner"/palpate-*) ||
  fail 'a removal while palpate ran has removed files'
wait "$running" || fail "palpate ended with an error while it was to be removed"

quietly "${wine[@]}" "$folder/uninstall.exe" /S
for _ in $(seq 100); do [ ! -e "$folder/uninstall.exe" ] || sleep 0.1; done  # it goes on after its first process
wineserver -w
[ "$(below "$folder")" = ./share/mine.txt ] || fail "left: $(below "$folder")"
rm -r "$WINEPREFIX/drive_c/Möbel und Töne"
left=$(diff "$scratch/before" <(below "$WINEPREFIX/drive_c") | grep -v -E '^[0-9]|/Temp/|/windows/' || true)
[ -z "$left" ] || fail "left or missing: $left"
left=$(diff <(grep -i palpate "$scratch/before.reg") <(registry | grep -i palpate) || true)
[ -z "$left" ] || fail "left in the registry: $left"

# A search path that is too long for NSIS stays as it is.
long=$(printf 'C:\\long%.0s;' $(seq 200))
quietly "${wine[@]}" reg add 'HKCU\Environment' /v Path /t REG_EXPAND_SZ /d "$long" /f
quietly "${wine[@]}" "$installer" /S /PATH
[ "$(registry | grep -c '^"Path".*long.*long;"$')" = 1 ] || fail 'a long search path was changed'
sizes=$(cd "$packages" && du -h palpate-*.exe palpate-*.zip | tr '\n\t' ', ')
echo "windows_packages.sh: installed, used, removed: $sizes"
