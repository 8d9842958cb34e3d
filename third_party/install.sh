#!/usr/bin/env bash
# Installs what a fresh Debian 12 needs to build, test and demonstrate palpate. Idempotent; as root, or with sudo.
#   third_party/install.sh            install what is missing
#   third_party/install.sh --check    only list what is missing; exit 1 if anything is
set -euo pipefail

packages=(
  build-essential            # compiler and linker
  cmake                      # build generator, 3.25 or newer
  ninja-build                # build tool of the presets
  ca-certificates            # lets apt verify the archives it reads from
  glslang-tools              # GLSL to SPIR-V at build time
  spirv-tools                # spirv-val checks every module that is built
  libvulkan-dev              # Vulkan headers and loader
  libvulkan-volk-dev         # volk: loads Vulkan entry points per device
  vulkan-validationlayers    # --validate and the tests
  mesa-vulkan-drivers        # lavapipe, the software driver that the tests run on
  libglm-dev                 # vectors and matrices
  libfmt-dev                 # text formatting (g++ 12 has no std::format)
  libcli11-dev               # command line
  nlohmann-json3-dev         # --json
  libglfw3-dev               # the window of palpate view
  libimgui-dev               # its panels
  fonts-dejavu-core          # their font
  libstb-dev                 # PNG writing and reading
  libnanoflann-dev           # k-d tree: normals and spacing on load, reference neighbour sets
  doctest-dev                # tests
  xvfb                       # a display for the tests of the window, and
  xauth                      # what its xvfb-run needs
  python3-matplotlib         # forces.png
)

usage() { sed -n '2,4s/^# \{0,1\}//p' "$0"; }

missing=()
for name in "${packages[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$name")
done

case "${1:-}" in
  --check)
    if [ ${#missing[@]} -eq 0 ]; then echo "install.sh: nothing is missing"; exit 0; fi
    printf 'missing: %s\n' "${missing[@]}"
    exit 1 ;;
  "") ;;
  -h | --help) usage; exit 0 ;;
  *) echo "install.sh: unknown option '$1'; use --check or nothing" >&2; exit 2 ;;
esac

if [ ${#missing[@]} -eq 0 ]; then echo "install.sh: nothing to do"; exit 0; fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "install.sh: needs root or sudo to install: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "install.sh: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
