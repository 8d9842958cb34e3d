#!/usr/bin/env bash
# Installs what a fresh Debian 12 needs to build, test and demonstrate palpate. Idempotent; as root, or with sudo.
#   third_party/install.sh            install what is missing
#   third_party/install.sh --check    only list what is missing; exit 1 if anything is
#   third_party/install.sh --windows  the same for the build for Windows as well (windows.sh)
#   third_party/install.sh --arm64    the same for the build for Arm (arm64.sh)
#   third_party/install.sh --udev     only let users open 3D mice, DualSenses and haptic styluses (70-palpate.rules)
set -euo pipefail

packages=(
  build-essential            # compiler and linker
  cmake                      # build generator, 3.25 or newer
  ninja-build                # build tool of the presets
  ccache                     # reuses earlier compilations
  lld                        # links tests in half the time
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
  libx11-dev                 # pictures for displays that a GPU cannot present to
  libimgui-dev               # panels of the window
  fonts-dejavu-core          # font of the window
  fonts-droid-fallback       # Chinese, Japanese and Korean letters in the window
  libstb-dev                 # PNG writing and reading
  zlib1g-dev                 # ZIP and gzip
  libnanoflann-dev           # k-d trees that benches compare with
  libpugixml-dev             # the XML of E57
  libdraco-dev               # glTF that is compressed by Draco
  libmeshoptimizer-dev       # glTF that is compressed by meshoptimizer
  libboost-dev               # Boost.Beast: WebSocket, as which the service of Haply devices answers (headers only)
  libhidapi-dev              # 3D mice and gamepads (its back end over the kernel's nodes: libhidapi-hidraw0)
  pybind11-dev               # the Python module
  python3-dev                # headers for the Python module
  python3-numpy              # arrays of the Python module
  python3-pytest             # tests of the Python module
  mypy                       # type checks of the Python module
  python3-sphinx             # reference of the Python module
  doxygen                    # reference of the C and C++ headers
  cyclonedds-dev             # DDS: sessions shared by several machines
  cyclonedds-tools           # idlc, which compiles the network messages
  libssl-dev                 # keys of encrypted sessions
  doctest-dev                # tests
  clang-format               # version 14: the format of the sources, which a test checks
  clang-tidy                 # version 14: checks the sources (tests/lint.sh)
  zsh                        # runs its completion in a test
  xvfb                       # a display for the tests of the window
  xauth                      # required by xvfb-run
  iproute2                   # a slow link between two network namespaces, for the tests of sharing
  libfastrtps-dev            # another vendor's DDS, for interoperability tests of sharing
  libfastcdr-dev             # message encoding of that DDS
  desktop-file-utils         # checks the desktop entry of the packages
  appstream                  # checks their description for software centres
  lintian                    # checks the packages
  patchelf                   # lets the wheel and the archive find the libraries inside them
  python3-venv               # installs the wheel in a test
  tshark                     # decodes the traffic in the tests of sharing
  python3-pysph              # another program's dam break, compared with palpate's in tests
  python3-matplotlib         # forces.png
)

windows_packages=(
  g++-mingw-w64-x86-64-posix # compiler; the threads of its standard library are POSIX's
  dpkg-dev                   # unpacks Debian's sources of the libraries
  wine64                     # runs the tests
  wine                       # the command wine
  nsis                       # makes the installer
)

arm64_packages=(
  g++-aarch64-linux-gnu      # compiler
  qemu-user                  # runs the tests
)

usage() { sed -n '2,7s/^# \{0,1\}//p' "$0"; }

as_root=()
become_root() {  # TO-DO-WHAT
  [ "$(id -u)" -eq 0 ] && return
  command -v sudo >/dev/null || { echo "install.sh: needs root or sudo to $1" >&2; exit 1; }
  as_root=(sudo)
}

# Installs the rule and applies it to devices that are already plugged in.
install_udev_rule() {
  local rule target=/etc/udev/rules.d/70-palpate.rules
  rule="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/70-palpate.rules"
  if cmp -s "$rule" "$target"; then
    echo "install.sh: $target is up to date"
  else
    become_root "write $target"
    "${as_root[@]}" install -D -m 0644 "$rule" "$target"
    echo "install.sh: wrote $target"
  fi
  if ! command -v udevadm >/dev/null; then
    echo "install.sh: udevadm is missing; the rule applies once udev runs"
    return
  fi
  become_root "reload the udev rules"
  if ! "${as_root[@]}" udevadm control --reload; then
    echo "install.sh: udev does not run; the rule applies once it does"
    return
  fi
  "${as_root[@]}" udevadm trigger --subsystem-match=hidraw --action=change
  echo "install.sh: the rule applies now, also to devices already plugged in; over ssh it requires the group plugdev"
}

if [ "${1:-}" = --windows ]; then packages+=("${windows_packages[@]}"); fi
if [ "${1:-}" = --arm64 ]; then packages+=("${arm64_packages[@]}"); fi
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
  "" | --windows | --arm64) ;;
  --udev) install_udev_rule; exit 0 ;;
  -h | --help) usage; exit 0 ;;
  *) echo "install.sh: unknown option '$1'; use --check, --windows, --arm64, --udev or nothing" >&2; exit 2 ;;
esac

if [ ${#missing[@]} -eq 0 ]; then echo "install.sh: nothing to do"; exit 0; fi

become_root "install: ${missing[*]}"
echo "install.sh: installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
