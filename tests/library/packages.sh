#!/usr/bin/env bash
# Configures the Debian packages, and checks where their files go, how they would be compiled, and what desktops show of
# them; builds nothing.
#   tests/library/packages.sh SOURCE_FOLDER
set -euo pipefail
[ -z "${PALPATE_TESTS_ONLY:-}" ] || { echo "packages: skipped: it has no label $PALPATE_TESTS_ONLY"; exit 77; }
[ -e /etc/debian_version ] || { echo "packages: skipped: this is not Debian"; exit 77; }
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT
fail() { echo "packages: $*" >&2; exit 1; }

cmake -S "$1" -B "$build" --preset packages > "$build/log" 2>&1 || fail "$(cat "$build/log")"
folder=lib/$(gcc -print-multiarch)
grep -q "$folder/libpalpate.so" "$build/haptics/library/cmake_install.cmake" || fail "the library is not in $folder"
grep -q "$folder/pkgconfig" "$build/haptics/library/cmake_install.cmake" || fail "palpate.pc is not in $folder"
for flag in -fstack-protector-strong -D_FORTIFY_SOURCE=2; do
  bare=$(grep '"command"' "$build/compile_commands.json" | grep -v nvcc | grep -cv -e "$flag" || true)
  [ "$bare" = 0 ] || fail "$bare files are compiled without $flag"
done

# What a desktop shows. The licence of the description itself is missing until the owner has chosen one.
desktop=$1/third_party/debian/palpate.desktop
if command -v desktop-file-validate > /dev/null; then
  desktop-file-validate --warn-kde "$desktop" || fail "$desktop is not valid"
else
  echo "packages: skipped: desktop-file-validate: not installed (desktop-file-utils)"
fi
if command -v appstreamcli > /dev/null; then
  found=$(appstreamcli validate --no-net --no-color "$build/debian/palpate.metainfo.xml" || true)
  errors=$(grep '^E: ' <<< "$found" | grep -v 'metadata-license-missing$' || true)
  [ -z "$errors" ] && grep -q 'metadata-license-missing' <<< "$found" || fail "for software centres: $found"
  warnings=$(grep '^W: ' <<< "$found" | grep -v 'cid-desktopapp-is-not-rdns' || true)  # palpate has no domain
  [ -z "$warnings" ] || fail "for software centres: $warnings"
else
  echo "packages: skipped: appstreamcli: not installed (appstream)"
fi
echo "packages: configured for /usr/$folder"
