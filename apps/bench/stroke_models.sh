#!/bin/sh
# Fetches the models of stroke_models.txt from Debian packages into a folder, as PLY files with normals:
#   apps/bench/stroke_models.sh PALPATE FOLDER
# Package lists are kept in FOLDER/packages; those of the system stay as they are. Checks the files' checksums.
set -eu
palpate=$(realpath "$1")
list=$(dirname "$(realpath "$0")")/stroke_models.txt
mkdir -p "$2/packages/lists/partial" "$2/packages/cache/archives/partial" "$2/packages/files"
folder=$(realpath "$2")
cd "$folder/packages"
# The system's own archive, with its sources.
apt-get indextargets --format 'deb-src $(SITE) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' |
  sort -u | sed 'p; s/^deb-src/deb/' > sources.list
apt() {
  apt-get -qq -o Dir::Etc::sourcelist="$PWD/sources.list" -o Dir::Etc::sourceparts=- \
    -o Dir::State::lists="$PWD/lists" -o Dir::Cache="$PWD/cache" -o APT::Sandbox::User=root "$@"
}
[ -e updated ] || { apt update && touch updated; }
grep -v '^#' "$list" | while read -r name kind package file samples sum; do
  if [ ! -e "files/$file" ]; then
    case $package in
      binary:*)
        ls "${package#binary:}"_*.deb > /dev/null 2>&1 || apt download "${package#binary:}"
        dpkg-deb -x "${package#binary:}"_*.deb unpacked
        tar xzf "$(find unpacked -name data.tar.gz)" -C files "$file"
        ;;
      source:*)
        ls "${package#source:}"_*.orig*.tar.* > /dev/null 2>&1 ||
          apt --download-only --tar-only source "${package#source:}"
        for archive in "${package#source:}"_*.orig*.tar.*; do
          tar xf "$archive" -C files "$file" 2> /dev/null || true
        done
        ;;
    esac
  fi
  echo "$sum  files/$file" | sha256sum --check --quiet
  sampled=
  [ "$samples" = 0 ] || sampled="--samples $samples"
  # shellcheck disable=SC2086
  "$palpate" convert "files/$file" "$folder/$name.ply" $sampled --force > /dev/null
  echo "$name ($kind)"
done
