#!/usr/bin/env bash
# The functions that the C headers in a folder declare, one on each line, in order.
#   tests/consumers/declared.sh FOLDER
set -euo pipefail
sed -n -e 's/^PP_API .*[ *]\(pp_[a-z_]*\)(.*/\1/p' -e 's/^PP_OPTIONS(\([a-z_]*\))$/pp_init_\1/p' "$1"/*.h | sort
