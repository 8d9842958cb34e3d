#!/usr/bin/env bash
# Checks the sources of engine, haptics and apps with clang-tidy; .clang-tidy names the checks and the exceptions.
#   tests/lint.sh          all sources that this machine can build
#   tests/lint.sh FILE...  these sources
# Configures build/tidy (without precompiled headers, which are GCC's) and builds the headers that are generated.
# Prints each finding once; exit code 1 if there is one. What was clean is remembered in build/tidy: only sources that
# changed, or whose headers, command or checks changed, are checked again. Requires clang-tidy 14 (Debian 12).
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

clang-tidy --version 2> /dev/null | grep -q 'version 14\.' || {
  echo "lint.sh: requires clang-tidy 14; third_party/install.sh installs it (Debian 12's package clang-tidy)" >&2
  exit 1
}
log=build/tidy/configure.log
mkdir -p build/tidy
configure() {
  cmake --preset release -B build/tidy -DPALPATE_PRECOMPILE=OFF || return
  # idlc writes headers; all others are written while the build is configured. Without DDS there is no idlc.
  cmake --build build/tidy --target help > build/tidy/targets || return
  ! grep -q '^palpate_sharing_types:' build/tidy/targets || cmake --build build/tidy --target palpate_sharing_types
}
if ! configure > "$log" 2>&1; then
  tail -n 20 "$log" >&2
  echo "lint.sh: build/tidy could not be configured ($log)" >&2
  exit 1
fi
exec python3 tests/lint.py build/tidy "$@"
