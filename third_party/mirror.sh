#!/usr/bin/env bash
# Prints the address of this machine's Debian 12 mirror, for scripts that download from it with their own lists.
set -euo pipefail
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Codename: bookworm' 'Component: main' \
  | sed -n 1p)
[ -n "$mirror" ] || { echo "mirror.sh: apt has no source for Debian 12 (bookworm, main)" >&2; exit 1; }
echo "$mirror"
