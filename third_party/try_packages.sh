#!/usr/bin/env bash
# Installs the packages of `cpack --preset packages` into a bare Debian 12 and uses each of them there: the archive and,
# if there is one among the packages, the wheel, before any package is installed; the program without a GPU driver and
# with one, Python, and programs in C and C++ that see only the installed headers. Removes all of them again and looks
# for remaining files. Requires root; debootstrap recreates that Debian below build/ each time.
#   third_party/try_packages.sh [FOLDER_OF_PACKAGES]
set -euo pipefail
cd "$(dirname "$0")/.."
packages=$(readlink -f "${1:-build/packages/packages}")
debian=$PWD/build/clean_debian

fail() { echo "try_packages.sh: $*" >&2; exit 1; }
say() { printf '\n== %s\n' "$*"; }

[ "$(id -u)" -eq 0 ] || fail "requires root for chroot"
command -v debootstrap > /dev/null || fail "requires debootstrap: apt-get install debootstrap"
ls "$packages"/*.deb > /dev/null 2>&1 || fail "no packages in $packages; cpack --preset packages makes them"
# A mount namespace: the mounts below that Debian end with this process, however it ends.
if [ "${PALPATE_TRIES:-}" != own ]; then
  PALPATE_TRIES=own exec unshare --mount bash "$PWD/third_party/try_packages.sh" "$packages"
fi

say "installing a bare Debian"
rm -rf "$debian"
mirror=$(bash third_party/mirror.sh)
debootstrap --variant=minbase --include=ca-certificates bookworm "$debian" "$mirror" > build/clean_debian.log 2>&1 \
  || fail "debootstrap: $(tail -n 3 build/clean_debian.log)"
mount -t proc proc "$debian/proc"
mount --rbind /dev "$debian/dev"
cp /etc/resolv.conf "$debian/etc/resolv.conf" 2> /dev/null || true
cp -r /etc/apt/apt.conf.d/. "$debian/etc/apt/apt.conf.d/"  # how this machine reaches the network
mkdir "$debian/packages"
cp "$packages"/*.deb "$packages"/*.tar.gz "$debian/packages/"
cp "$packages"/*.whl "$debian/packages/" 2> /dev/null || echo "try_packages.sh: skipped: no wheel in $packages"
cp -r apps/examples "$debian/examples"

inside() {  # COMMANDS: runs them there in a clean environment
  chroot "$debian" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
    DEBIAN_FRONTEND=noninteractive ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
    bash -euo pipefail -c "cd /root; $1"
}
install() {
  inside "apt-get install -y --no-install-recommends $* > /tmp/apt.log 2>&1 || { tail -n 20 /tmp/apt.log; exit 1; }"
}

inside 'apt-get update > /tmp/apt.log 2>&1 || { tail /tmp/apt.log; exit 1; }; dpkg-query -W | wc -l > /tmp/before'
inside 'find / -xdev -path /packages -prune -o -path /examples -prune -o -iname "*palpate*" -print' \
  > build/clean_debian.log
[ -s build/clean_debian.log ] && fail "files of palpate exist already: $(cat build/clean_debian.log)"

# A model written by hand: a plane with a hump.
inside 'awk "BEGIN {print \"x,y,z\"; for (i = -60; i <= 60; ++i) for (j = -60; j <= 60; ++j)
  printf \"%g,%g,%g\\n\", i, j, 20 * exp(-(i * i + j * j) / 800)}" > hump.csv'

say "the archive"
inside 'tar xzf /packages/palpate-*.tar.gz; cd palpate-*/bin
  ./palpate make sculpture -n 20000 -o cloud.ply; ./palpate convert cloud.ply cloud.laz; ./palpate info cloud.laz
  ./palpate touch cloud.laz --backend cpu; if ./palpate doctor; then echo "a GPU without a loader"; exit 1; fi'

say "the wheel"
if compgen -G "$debian/packages/*.whl" > /dev/null; then
  install python3-numpy python3-venv
  inside 'python3 -m venv --system-site-packages venv; venv/bin/pip install -q --no-index /packages/*.whl
    venv/bin/python /examples/dent.py hump.csv dented.ply; test "$(head -c 3 dented.ply)" = ply; rm -r venv dented.ply'
fi

say "the program, without a GPU driver"
install '/packages/palpate_*.deb'
inside 'palpate --version; palpate make sculpture -n 200000 -o cloud.ply
  for other in las laz pcd npy csv; do palpate convert cloud.ply cloud.$other; done
  palpate info cloud.laz; palpate touch cloud.laz --backend cpu; palpate simulate jelly --duration 0.2
  test -s /usr/share/man/man1/palpate.1.gz; test -s /usr/share/applications/palpate.desktop
  if ldd /usr/bin/palpate | grep "not found"; then exit 1; fi
  if palpate touch cloud.laz --backend vulkan 2> said; then echo "a GPU without a driver"; exit 1; fi; cat said'

say "the program, with lavapipe"
install mesa-vulkan-drivers libvulkan1
inside 'palpate doctor | head -n 30; palpate touch cloud.laz --backend vulkan; palpate render cloud.laz -o picture.png
  test "$(head -c 4 picture.png | tail -c 3)" = PNG'

say "Python"
install '/packages/libpalpate0_*.deb' '/packages/python3-palpate_*.deb'
inside 'python3 /examples/dent.py hump.csv dented.ply; test "$(head -c 3 dented.ply)" = ply
  python3 -c "import palpate, time; print(palpate.__version__, palpate.Session(palpate.read(\"cloud.laz\"), gpu=None))"'

say "programs in C and C++"
install '/packages/libpalpate-dev_*.deb' g++ cmake make pkg-config
inside 'library=$(gcc -print-multiarch)/libpalpate.so.0; test -e "/usr/lib/$library"
  for file in "/usr/lib/$library" /usr/bin/palpate; do
    readelf -d "$file" | grep BIND_NOW; nm -D "$file" | grep __stack_chk_fail; nm -D "$file" | grep -c _chk@
  done
  cmake -S /examples -B built -DCMAKE_BUILD_TYPE=Release > cmake.log || { cat cmake.log; exit 1; }
  cmake --build built > cmake.log || { cat cmake.log; exit 1; }
  built/press; built/dent hump.csv dented.ply; built/stir
  cc -o press /examples/press.c $(pkg-config --cflags --libs palpate) -lm; ./press'

say "removing the packages"
inside 'apt-get purge -y palpate libpalpate0 libpalpate-dev python3-palpate > /tmp/apt.log 2>&1 \
    || { tail /tmp/apt.log; exit 1; }
  rm -rf /root/*'
left=$(inside 'find / -xdev -path /packages -prune -o -path /examples -prune -o -path /proc -prune \
  -o -path /root -prune -o -iname "*palpate*" -print')
[ -z "$left" ] || fail "left behind: $left"
echo "try_packages.sh: all packages were installed, used and removed"
