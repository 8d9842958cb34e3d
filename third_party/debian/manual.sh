#!/usr/bin/env bash
# Generates the manual page from the program's help.
#   third_party/debian/manual.sh PROGRAM VERSION PAGE.gz
set -euo pipefail
program=$1 version=$2 page=$3

# Escapes text for roff.
plain() { sed -e 's/\\/\\e/g' -e 's/-/\\-/g' -e "s/^\([.']\)/\\\\\&\1/"; }
shown() { printf '.nf\n'; plain; printf '.fi\n'; }

commands=$("$program" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
[ -n "$commands" ] || { echo "manual.sh: the help of $program names no subcommands" >&2; exit 1; }
mkdir -p "$(dirname "$page")"
{
  printf '.TH PALPATE 1 "" "palpate %s" "User commands"\n' "$version"
  printf '.SH NAME\npalpate \\- feel, see and sculpt point clouds in real time\n'
  printf '.SH SYNOPSIS\n.B palpate\n.I COMMAND\n[\n.I OPTIONS\n]\n.br\n.B palpate\n.IR MODEL ...\n'
  printf '.SH DESCRIPTION\n'
  "$program" --help | shown
  printf '.SH COMMANDS\n'
  for command in $commands; do
    printf '.SS palpate %s\n' "$command"
    "$program" "$command" --help-all | shown
  done
  printf '.SH EXIT STATUS\n0: done; 1: failed, one line states what, where and what to do; 2: wrong usage;\n'
  printf '130, 143: ended by SIGINT, SIGTERM.\n'
  printf '.SH ENVIRONMENT\n.TP\n.B PALPATE_GPU\n'
  printf 'The GPU, by number or part of its name, where one is used and\n.B \\-\\-gpu\nis not given.\n'
  printf 'Unlike that option it does not make\n.B touch\nuse a GPU.\n'
  printf '.TP\n.BR PALPATE_HD_LIBRARY ", " PALPATE_DHD_LIBRARY\n'
  printf "Libraries of haptic devices in place of the vendors'.\n"
  printf '.SH COPYRIGHT\nNo licence has been chosen by the owner of palpate.\n'
} | gzip -9n > "$page"
