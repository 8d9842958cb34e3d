#!/usr/bin/env bash
# Builds the parts that need no GPU for 64-bit Arm Linux, on Debian 12 of another processor, and runs their tests under
# qemu. Idempotent; the arm64 packages are unpacked below build/, and the machine's own are unchanged.
#   third_party/arm64.sh               build/arm64, and its tests
#   third_party/arm64.sh --libraries   only its libraries, in build/arm64-libraries/root
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

place=$PWD/build/arm64-libraries
root=$place/root
packages=(libc6-dev libstdc++6 libfmt-dev libglm-dev nlohmann-json3-dev libhidapi-dev libnanoflann-dev libstb-dev
          libboost-dev zlib1g-dev doctest-dev)

usage() { sed -n '2,5s/^# \{0,1\}//p' "$0"; }

# Downloads the packages and their dependencies: apt is configured for an arm64 machine without installed packages.
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
  # Absolute links, such as /lib/aarch64-linux-gnu/libc.so.6, would lead to this machine's files.
  find "$root" -type l -lname '/*' | while read -r file; do ln -sfrn "$root$(readlink "$file")" "$file"; done
  # For packages whose files contain the prefix /usr.
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
