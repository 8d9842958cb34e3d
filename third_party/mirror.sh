#!/usr/bin/env bash
# Prints where this machine reads Debian 12 from, for the scripts that fetch more of it with lists of their own.
set -euo pipefail
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Codename: bookworm' 'Component: main' \
  | sed -n 1p)
[ -n "$mirror" ] || { echo "mirror.sh: apt reads no Debian 12 (bookworm, main) here" >&2; exit 1; }
echo "$mirror"
