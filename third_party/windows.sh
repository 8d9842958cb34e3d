#!/usr/bin/env bash
# Builds palpate for Windows on Debian 12, from its own sources and Debian's: program and library, an installer, and a
# zip of the same files. Idempotent; downloads and builds stay below build/.
#   third_party/windows.sh               build/windows/palpate-VERSION-windows-x86_64.exe, and the zip beside it
#   third_party/windows.sh --libraries   only its libraries, in build/windows-libraries/prefix
#   third_party/windows.sh --check       checks whether the tests can run here; if not, prints the reason, exit 1
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.."

place=$PWD/build/windows-libraries
prefix=$place/prefix
sources=(fmtlib glfw3 hidapi imgui pugixml zlib)  # Debian's source packages of the libraries
# Header-only libraries: equal on every system, copied from the packages that install.sh installs.
headers=(libglm-dev nlohmann-json3-dev libcli11-dev doctest-dev libnanoflann-dev libstb-dev libvulkan-dev
         libvulkan-volk-dev libboost1.74-dev)

usage() { sed -n '2,6s/^# \{0,1\}//p' "$0"; }

# Downloads the sources by apt, with package lists separate from the system's.
fetch() {
  local apt=(apt-get -q -o Dir::Etc::sourcelist="$place/debian.sources" -o Dir::Etc::sourceparts=/dev/null
             -o Dir::State::lists="$place/lists" -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache=
             -o APT::Sandbox::User=root)
  mkdir -p "$place/lists/partial" "$place/sources"
  local mirror
  mirror=$(bash third_party/mirror.sh)
  cat > "$place/debian.sources" <<END
Types: deb-src
URIs: $mirror
Suites: bookworm
Components: main
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg
END
  "${apt[@]}" update
  (cd "$place/sources" && "${apt[@]}" source "${sources[@]}")
}

cmake_library() {  # NAME OPTIONS...: builds the source package NAME
  local name=$1
  shift
  cmake -G Ninja -S "$place/sources/$name"-[0-9]*/ -B "$place/build/$name" -DCMAKE_INSTALL_PREFIX="$prefix" \
    -DCMAKE_TOOLCHAIN_FILE="$PWD/third_party/windows_toolchain.cmake" -DCMAKE_BUILD_TYPE=Release \
    -DBUILD_SHARED_LIBS=OFF "$@" > "$place/build/$name.log"
  cmake --build "$place/build/$name" --target install >> "$place/build/$name.log"
}

# Debian's makefile is for Linux; the core is these four files.
build_imgui() {
  local folder file
  folder=$(echo "$place"/sources/imgui-[0-9]*/)
  mkdir -p "$place/build/imgui" "$prefix/include/imgui" "$prefix/lib"
  for file in imgui imgui_draw imgui_tables imgui_widgets; do
    x86_64-w64-mingw32-g++-posix -O2 -c "$folder/$file.cpp" -o "$place/build/imgui/$file.o"
  done
  rm -f "$prefix/lib/libimgui.a"
  x86_64-w64-mingw32-ar rcs "$prefix/lib/libimgui.a" "$place"/build/imgui/*.o
  cp "$folder"/*.h "$prefix/include/imgui/"
}

# Debian's sources lack the files for Windows, which only a shared library needs.
build_zlib() {
  local folder file
  folder=$(echo "$place"/sources/zlib-[0-9]*/)
  mkdir -p "$place/build/zlib" "$prefix/include" "$prefix/lib"
  cp "$folder/zlib.h" "$prefix/include/"
  cp "$folder/zconf.h.in" "$prefix/include/zconf.h"
  for file in adler32 crc32 inffast inflate inftrees zutil; do
    x86_64-w64-mingw32-gcc-posix -O2 -I "$prefix/include" -c "$folder/$file.c" -o "$place/build/zlib/$file.o"
  done
  rm -f "$prefix/lib/libz.a"
  x86_64-w64-mingw32-ar rcs "$prefix/lib/libz.a" "$place"/build/zlib/*.o
}

# A separate include folder: the system's would add the headers of Linux.
copy_headers() {
  mkdir -p "$prefix"
  dpkg -L "${headers[@]}" | sed -n -E 's#^/usr/((include|(lib|share)/(.*/)?cmake)/.*)#\1#p' |
    tar --create --directory=/usr --no-recursion --dereference --files-from=- | tar --extract --directory="$prefix"
  # For packages whose files contain the prefix /usr.
  find "$prefix" -name '*.cmake' -exec sed -i "s|set(_IMPORT_PREFIX \"/usr\")|set(_IMPORT_PREFIX \"$prefix\")|" {} +
}

# The terms on which the linked libraries and the font may be distributed.
copy_licences() {
  local name
  for name in "${sources[@]}"; do
    install -D -m 644 "$place/sources/$name"-[0-9]*/debian/copyright "$prefix/licences/$name.txt"
  done
  for name in "${headers[@]}" fonts-dejavu-core gcc-mingw-w64-x86-64-posix mingw-w64-x86-64-dev; do
    install -D -m 644 "/usr/share/doc/$name/copyright" "$prefix/licences/$name.txt"
  done
}

build_libraries() {
  if [ -f "$place/done" ] && [ "$place/done" -nt third_party/windows.sh ]; then return; fi
  bash third_party/install.sh --windows
  rm -rf "$place/build" "$prefix" "$place/sources"
  mkdir -p "$place/build"
  fetch
  copy_headers
  cmake_library fmtlib -DFMT_DOC=OFF -DFMT_TEST=OFF
  cmake_library glfw3 -DGLFW_BUILD_DOCS=OFF -DGLFW_BUILD_TESTS=OFF -DGLFW_BUILD_EXAMPLES=OFF
  cmake_library hidapi -DHIDAPI_BUILD_HIDTEST=OFF
  x86_64-w64-mingw32-objcopy --remove-section=.drectve "$prefix/lib/libhidapi.a"  # or palpate.dll would export it
  cmake_library pugixml
  build_imgui
  build_zlib
  copy_licences
  touch "$place/done"
}

# Prints nothing, or why the tests cannot run.
what_is_missing() {
  if [ ! -f "$place/done" ]; then echo "the libraries are not built (run third_party/windows.sh)"; fi
  if ! command -v wine > /dev/null; then echo "wine is not installed (run third_party/install.sh --windows)"; fi
  if ! command -v makensis > /dev/null; then echo "NSIS is not installed (run third_party/install.sh --windows)"; fi
}

case "${1:-}" in
  --check)
    missing=$(what_is_missing)
    if [ -z "$missing" ]; then exit 0; fi
    echo "windows.sh: $missing" >&2
    exit 1 ;;
  --libraries) build_libraries; exit 0 ;;
  "") ;;
  -h | --help) usage; exit 0 ;;
  *) echo "windows.sh: unknown option '$1'; use --libraries, --check or nothing" >&2; exit 2 ;;
esac

build_libraries
cmake --preset windows
cmake --build --preset windows
cpack --preset windows
