#!/usr/bin/env bash
# Checks the packages of `cpack --preset packages` without installing them: lintian finds no error and no warning, and
# what is in them runs when unpacked anywhere, also where there is no Vulkan loader.
#   tests/library/built_packages.sh FOLDER_OF_PACKAGES
set -euo pipefail
packages=$(cd "$1" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
fail() { echo "built_packages: $*" >&2; exit 1; }

if command -v lintian > /dev/null; then
  lintian --allow-root --fail-on error,warning "$packages"/*.deb > "$scratch/lintian" 2>&1 \
    || fail "lintian: $(cat "$scratch/lintian")"
else
  echo "built_packages: skipped: lintian: not installed"
fi

# An empty file in place of the loader, for programs that look in this folder first.
mkdir "$scratch/no_loader"
touch "$scratch/no_loader/libvulkan.so" "$scratch/no_loader/libvulkan.so.1"
clean() {  # COMMAND...: without the settings of this session
  env -i PATH=/usr/bin:/bin HOME="$scratch" LC_ALL=C.UTF-8 PYTHONDONTWRITEBYTECODE=1 "$@"
}
works_without_a_gpu() {  # PROGRAM
  rm -f "$scratch"/cloud.*
  local program=(clean "LD_LIBRARY_PATH=$scratch/no_loader" "$1") cloud=$scratch/cloud.ply said=$scratch/said
  "${program[@]}" make sculpture -n 5000 -o "$cloud" 2> "$said" || fail "$(cat "$said")"
  "${program[@]}" info "$cloud" > "$said" || fail "info: $(cat "$said")"
  "${program[@]}" convert "$cloud" "$scratch/cloud.laz" 2> "$said" || fail "convert: $(cat "$said")"
  "${program[@]}" touch "$scratch/cloud.laz" --backend cpu > "$said" 2>&1 || fail "touch: $(cat "$said")"
  "${program[@]}" doctor > "$said" 2>&1 || true
  for part in 'GPU: none' '--device hid' 'work on the processor'; do
    grep -q -e "$part" "$said" || fail "doctor does not report '$part': $(cat "$said")"
  done
  for command in 'touch --backend vulkan' 'render -o out.png' 'mesh -o out.ply'; do
    # shellcheck disable=SC2086
    if "${program[@]}" $command "$cloud" > "$said" 2>&1; then fail "$command ran on a GPU without a loader"; fi
    [ "$(grep -c 'install the package libvulkan1' "$said")" = 1 ] || fail "$command: $(cat "$said")"
  done
}

for package in "$packages"/*.deb; do dpkg-deb -x "$package" "$scratch/debian"; done
works_without_a_gpu "$scratch/debian/usr/bin/palpate"
man=$scratch/debian/usr/share/man/man1/palpate.1.gz
! command -v man > /dev/null || [ -z "$(LC_ALL=C.UTF-8 man --warnings -l "$man" 2>&1 > /dev/null)" ] \
  || fail "the manual has errors"

# The archive, below a path with a space: its own libraries are found there, and no other than the runtimes elsewhere.
mkdir "$scratch/any where"
tar xzf "$packages"/palpate-*.tar.gz -C "$scratch/any where"
mv "$scratch/any where"/palpate-* "$scratch/any where/moved"
moved="$scratch/any where/moved"
works_without_a_gpu "$moved/bin/palpate"
while IFS= read -r file; do
  elsewhere=$(clean ldd "$file" | grep -v -F "$moved" |
    grep -v -E '^\s*(linux-vdso|/lib.*ld-linux|lib(c|m|dl|pthread|rt|gcc_s|stdc\+\+)\.so)' || true)
  [ -z "$elsewhere" ] || fail "$file takes libraries from elsewhere: $elsewhere"
done < <(find "$moved" -type f \( -name '*.so*' -o -path '*/bin/palpate' \))
examples=$moved/share/doc/palpate/examples
clean cmake -S "$examples" -B "$scratch/built" -DCMAKE_PREFIX_PATH="$moved" > "$scratch/said" 2>&1 \
  && clean cmake --build "$scratch/built" --target press > "$scratch/said" 2>&1 || fail "$(cat "$scratch/said")"
clean "$scratch/built/press" > "$scratch/said" 2>&1 || fail "press: $(cat "$scratch/said")"
module=$(find "$moved" -path '*dist-packages/palpate' || true)
if [ -n "$module" ]; then
  # A model in a text format: a plane with a hump.
  awk 'BEGIN {print "x,y,z"; for (i = -60; i <= 60; ++i) for (j = -60; j <= 60; ++j)
    printf "%g,%g,%g\n", i, j, 20 * exp(-(i * i + j * j) / 800)}' > hump.csv
  clean PYTHONPATH="$(dirname "$module")" /usr/bin/python3 "$examples/dent.py" hump.csv dented.ply | tee "$scratch/said"
  ! grep -q ' 0.000 N' "$scratch/said" || fail "Python felt nothing"
else
  echo "built_packages: skipped: Python: the module was not built"
fi
echo "built_packages: unpacked and used: $(du -h "$packages"/palpate* | tr '\n\t' ', ')"
