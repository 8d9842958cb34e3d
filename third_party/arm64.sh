#!/usr/bin/env bash
# Builds what needs no GPU for Linux on Arm of 64 bits, on a Debian 12 of another machine, and runs its tests under
# qemu. Idempotent; the packages of arm64 are laid out below build/, and the machine's own stay as they are.
#   third_party/arm64.sh               build/arm64, and its tests
#   third_party/arm64.sh --libraries   only what it is linked to, in build/arm64-libraries/root
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

place=$PWD/build/arm64-libraries
root=$place/root
packages=(libc6-dev libstdc++6 libfmt-dev libglm-dev nlohmann-json3-dev libhidapi-dev libnanoflann-dev libstb-dev
          doctest-dev)

usage() { sed -n '2,5s/^# \{0,1\}//p' "$0"; }

# Downloads the packages and their dependencies for arm64: apt is told of such a machine with nothing installed.
fetch() {
  local apt=(apt-get -q -y -o APT::Architecture=arm64 -o APT::Architectures=arm64
             -o Dir::Etc::sourcelist="$place/debian.sources" -o Dir::Etc::sourceparts=/dev/null
             -o Dir::State::lists="$place/lists" -o Dir::State::status="$place/status" -o Dir::Cache="$place/cache"
             -o APT::Sandbox::User=root)
  mkdir -p "$place/lists/partial" "$place/cache/archives/partial"
  : > "$place/status"
  local mirror
  mirror=$(bash third_party/mirror.sh)
  cat > "$place/debian.sources" <<END
Types: deb
URIs: $mirror
Suites: bookworm
Components: main
Architectures: arm64
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg
END
  "${apt[@]}" update
  "${apt[@]}" --no-install-recommends --download-only install "${packages[@]}"
}

build_libraries() {
  if [ -f "$place/done" ] && [ "$place/done" -nt third_party/arm64.sh ]; then return; fi
  bash third_party/install.sh --arm64
  rm -rf "$root"
  mkdir -p "$root"
  fetch
  local file
  for file in "$place"/cache/archives/*.deb; do dpkg -x "$file" "$root"; done
  # Links from the top, as /lib/aarch64-linux-gnu/libc.so.6, would lead to this machine.
  find "$root" -type l -lname '/*' | while read -r file; do ln -sfrn "$root$(readlink "$file")" "$file"; done
  # Where a package says by itself that it lies in /usr.
  find "$root" -name '*.cmake' -exec sed -i "s|set(_IMPORT_PREFIX \"/usr\")|set(_IMPORT_PREFIX \"$root/usr\")|" {} +
  touch "$place/done"
}

case "${1:-}" in
  --libraries) build_libraries; exit 0 ;;
  "") ;;
  -h | --help) usage; exit 0 ;;
  *) echo "arm64.sh: unknown option '$1'; use --libraries or nothing" >&2; exit 2 ;;
esac

build_libraries
cmake --preset arm64
cmake --build --preset arm64 --target all_tests
ctest --preset arm64 -L host
