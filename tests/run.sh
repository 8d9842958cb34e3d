#!/usr/bin/env bash
# Installs what is missing, builds with validation and warnings as errors, and runs every test headless: on lavapipe,
# or on the GPU that PALPATE_GPU names. What runs on the CPU alone runs again under AddressSanitizer and UBSan, the
# servo loop under ThreadSanitizer, and on lavapipe the GPU passes, room by room, with one driver thread, which orders
# atomics differently. A leg that fails hides none behind it: all run, and the last lines name what failed.
set -euo pipefail
cd "$(dirname "$0")/.."

bash third_party/install.sh
export PALPATE_GPU=${PALPATE_GPU:-llvmpipe}

failed=()

leg() {  # NAME COMMAND...: whatever comes of it, the next one follows
  local name=$1 begin=$SECONDS
  shift
  printf '\n== %s\n' "$name"
  if "$@"; then
    printf '== %s: passed in %d s\n' "$name" $((SECONDS - begin))
  else
    failed+=("$name")
    return 1
  fi
}

build() {  # PRESET [OPTIONS...]
  cmake --preset "$1" > /dev/null && cmake --build --preset "$@"
}

tests() {  # NAME PRESET [OPTIONS...]: where they were built, and with the names of those that failed
  local name=$1 preset=$2 log="build/$2/Testing/Temporary/LastTestsFailed.log"
  shift 2
  case " $built " in
    *" $preset "*) ;;
    *) failed+=("$name: not run, not built"); return ;;
  esac
  rm -f "$log"
  leg "$name" ctest --preset "$preset" -j 2 --no-tests=error "$@" && return
  if [ -s "$log" ]; then failed[-1]="$name: $(sed 's/^[0-9]*://' "$log" | paste -sd ' ')"; fi
}

built=
leg 'build' build dev && built+=' dev'
leg 'build for AddressSanitizer and UBSan' build asan --target host_tests && built+=' asan'
leg 'build for ThreadSanitizer' build tsan --target tests_haptics && built+=' tsan'

tests 'under AddressSanitizer and UBSan' asan -L host
tests 'under ThreadSanitizer' tsan -R '^haptics\.'
if [ "$PALPATE_GPU" = llvmpipe ]; then
  LP_NUM_THREADS=1 tests 'with one driver thread' dev -R '^(gpu|spatial|contact|edit|mesh)\.'
fi
tests 'all' dev

echo
if [ ${#failed[@]} -eq 0 ]; then
  echo "run.sh: every leg passed, in $SECONDS s"
else
  printf 'run.sh: failed: %s\n' "${failed[@]}"
  exit 1
fi
