#!/usr/bin/env bash
# Installs the library of a build folder into a scratch folder, and builds and runs programs against that alone: in C,
# C++ and, if available, Python and C#; by the CMake package and, if available, by pkg-config.
#   tests/consumers/run.sh BUILD_FOLDER [PYTHON]
set -euo pipefail
[ -z "${PALPATE_TESTS_ONLY:-}" ] || { echo "consumers: skipped: it has no label $PALPATE_TESTS_ONLY"; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
python=${2:-python3}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

fail() { echo "consumers: $*" >&2; exit 1; }

for component in library dev python; do
  cmake --install "$build" --prefix "$scratch/installed" --component "$component" > "$scratch/install.log"
done
library=$(find "$scratch/installed" -name 'libpalpate.so.0')
[ -n "$library" ] || fail "there is no libpalpate.so.0"

# Only the C interface is exported, all functions of the headers are, and the library has its soname.
symbols=$(nm -D --defined-only --with-symbol-versions "$library" | awk '$2 != "A" {print $3}' | sort)
bare=$(grep -v '@@PALPATE_0$' <<< "$symbols" || true)
[ -z "$bare" ] || fail "exports without the version PALPATE_0: $bare"
exported=${symbols//@@PALPATE_0/}
strays=$(grep -v '^pp_' <<< "$exported" || true)
[ -z "$strays" ] || fail "unexpected exports: $strays"
declared=$(bash "$here/declared.sh" "$scratch/installed/include/palpate")
[ "$(wc -l <<< "$declared")" -gt 50 ] || fail "the headers declare too few functions"
[ "$declared" = "$exported" ] ||
  fail "headers and library differ: $(diff <(echo "$declared") <(echo "$exported") || true)"
readelf -d "$library" | grep -q 'SONAME.*\[libpalpate.so.0\]' || fail "wrong soname"
# The loader's tables are read-only: lazy binding would leave them writable.
readelf -lW "$library" | grep -q GNU_RELRO || fail "no read-only relocations"
readelf -d "$library" | grep -q BIND_NOW || fail "functions are bound lazily"
for other in glfw imgui X11; do
  if readelf -d "$library" | grep NEEDED | grep -qi "$other"; then fail "the library needs $other"; fi
done

# A moved tree works as well.
mv "$scratch/installed" "$scratch/moved"
examples=$scratch/moved/share/doc/palpate/examples
strict="-Wall -Wextra -Wpedantic -Wshadow -Werror"
for programs in "$examples" "$here"; do
  to=$scratch/build/$(basename "$programs")
  cmake -S "$programs" -B "$to" -DCMAKE_PREFIX_PATH="$scratch/moved" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_C_FLAGS="$strict -Wstrict-prototypes" -DCMAKE_CXX_FLAGS="$strict" \
    > "$scratch/configure.log" || fail "$(cat "$scratch/configure.log")"
  cmake --build "$to"
done
felt() {  # COMMAND...: checks that it prints the force of 1 mm at 0.8 N/mm
  "$@" | tee "$scratch/felt.txt"
  awk '{exit !($2 > 0.6 && $2 < 0.9)}' "$scratch/felt.txt" || fail "the force is not that of 1 mm at 0.8 N/mm"
}
felt "$scratch/build/examples/press"
felt "$scratch/build/consumers/hosted"

# A model in a text format: a plane with a hump.
awk 'BEGIN {print "x,y,z"; for (i = -60; i <= 60; ++i) for (j = -60; j <= 60; ++j)
  printf "%g,%g,%g\n", i, j, 20 * exp(-(i * i + j * j) / 800)}' > "$scratch/hump.csv"
"$scratch/build/examples/dent" "$scratch/hump.csv" "$scratch/dented.ply"
[ "$(head -c 3 "$scratch/dented.ply")" = ply ] || fail "nothing was saved"
"$scratch/build/examples/probe" "$scratch/hump.csv" | tee "$scratch/probe.txt" || fail "probe failed"
# The middle of the hump is 20 units high.
awk '/^hit/ {found = $2 > 19 && $2 < 20.1} END {exit !found}' "$scratch/probe.txt" || fail "the ray missed the hump"
"$scratch/build/examples/stir" || [ $? = 77 ] || fail "stir failed"

# One program serves a cloud, and two others dent it.
source "$(dirname "$0")/../own_domain.sh"
mkfifo "$scratch/end"
exec 3<> "$scratch/end"
"$scratch/build/examples/share" serve "$domain" < "$scratch/end" > "$scratch/serve.txt" &
server=$!
trap 'kill "$server" 2> /dev/null || true; rm -rf "$scratch"' EXIT
until grep -q serving "$scratch/serve.txt" 2> /dev/null; do kill -0 "$server" 2> /dev/null || break; sleep 0.1; done
if grep -q serving "$scratch/serve.txt"; then
  "$scratch/build/examples/share" join "$domain" 0 > "$scratch/one.txt" &
  one=$!
  "$scratch/build/examples/share" join "$domain" 6 > "$scratch/two.txt" ||
    fail 'the second hand did not dent the served cloud'
  wait "$one" || fail 'the first hand did not dent the served cloud'
  echo >&3
  wait "$server" || fail 'the server failed'
  grep -q '^sculptors 2$' "$scratch/serve.txt" ||
    fail "the served cloud was not dented by two hands: $(cat "$scratch/serve.txt")"
  points=$(grep points "$scratch/serve.txt")
  # The program that finished last has the server's points; the other one may have finished before the last edit.
  grep -qxF "$points" "$scratch/one.txt" "$scratch/two.txt" ||
    fail "the points differ: $(cat "$scratch"/{serve,one,two}.txt)"
  "$scratch/build/consumers/together" "$domain" || fail 'clouds differ between sessions of one program'
  echo "share: $points, of two hands and their server"
else
  code=0
  wait "$server" || code=$?
  [ "$code" = 77 ] || fail "share serve ended with $code"
  echo 'consumers: skipped: sharing: this library was built without it'
fi

if command -v pkg-config > /dev/null; then
  export PKG_CONFIG_PATH
  PKG_CONFIG_PATH=$(dirname "$(find "$scratch/moved" -name palpate.pc)")
  # shellcheck disable=SC2046
  ${CC:-cc} -o "$scratch/press" "$examples/press.c" $(pkg-config --cflags --libs palpate) -lm
  LD_LIBRARY_PATH=$(dirname "$(find "$scratch/moved" -name libpalpate.so.0)") felt "$scratch/press"
else
  echo "consumers: skipped: pkg-config: not installed"
fi

if command -v mcs > /dev/null && command -v mono > /dev/null; then
  mcs -out:"$scratch/Press.exe" "$examples/Press.cs"
  mcs -main:Throwing -out:"$scratch/Throwing.exe" "$examples/Press.cs" "$here/Throwing.cs"
  folder=$(dirname "$(find "$scratch/moved" -name libpalpate.so)")
  LD_LIBRARY_PATH=$folder felt mono "$scratch/Press.exe"
  LD_LIBRARY_PATH=$folder mono "$scratch/Throwing.exe" || fail "an exception of C# did not arrive after its call"
else
  echo "consumers: skipped: C#: the compiler is not installed (mono-mcs, mono-runtime)"
fi

module=$(find "$scratch/moved" -name 'palpate' -path '*dist-packages*')
if [ -n "$module" ]; then
  PYTHONPATH=$(dirname "$module") "$python" "$examples/dent.py" "$scratch/hump.csv" "$scratch/python.ply"
  [ "$(head -c 3 "$scratch/python.ply")" = ply ] || fail "Python saved nothing"
else
  echo "consumers: skipped: Python: the module was not built"
fi
echo "consumers: all programs ran"
