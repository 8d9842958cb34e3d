#!/usr/bin/env bash
# Installs what is missing, builds with validation and warnings as errors, and runs every test headless: on lavapipe,
# or on the GPU that PALPATE_GPU names. What runs on the CPU alone is built again without Vulkan, and runs so under
# AddressSanitizer and UBSan, the servo loop under ThreadSanitizer, and on lavapipe the GPU passes, room by room, with one
# driver thread, which orders atomics differently (without validation, which the last leg has), and again on another
# driver and under another validation layer, where those can be had. A leg that fails hides none behind it: all run, and
# the last lines name what failed. Where third_party/windows.sh has been, some tests run as programs for Windows, too, under
# wine; what is skipped is said.
set -euo pipefail
cd "$(dirname "$0")/.."

bash third_party/install.sh
export PALPATE_GPU=${PALPATE_GPU:-llvmpipe}

failed=()
skipped=()
around=()  # what the tests' own programs are started by

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
  leg "$name" "${around[@]}" ctest --preset "$preset" -j 2 --no-tests=error "$@" && return
  if [ -s "$log" ]; then failed[-1]="$name: $(sed 's/^[0-9]*://' "$log" | paste -sd ' ')"; fi
}

built=
leg 'build' build dev && built+=' dev'
leg 'build without Vulkan, for AddressSanitizer and UBSan' build asan --target host_tests && built+=' asan'
leg 'build for ThreadSanitizer' build tsan --target tests_haptics && built+=' tsan'

tests 'without Vulkan, under AddressSanitizer and UBSan' asan -L host
tests 'under ThreadSanitizer' tsan -R '^haptics\.'
if [ "$PALPATE_GPU" = llvmpipe ]; then
  LP_NUM_THREADS=1 PALPATE_TESTS_VALIDATE=0 tests 'with one driver thread' dev -L gpu -R '^(gpu|spatial|contact|edit|mesh)\.'
fi
if [ "$PALPATE_GPU" = llvmpipe ]; then
  # A third driver and a current layer judge what the packaged ones let pass. What that driver takes minutes for is left out.
  if drivers=$(bash third_party/drivers.sh); then
    VK_DRIVER_FILES=$drivers/swiftshader.json PALPATE_GPU=SwiftShader PALPATE_TESTS_VALIDATE=0 \
      tests 'on SwiftShader' dev -L gpu -R "$(paste -sd '|' tests/other_drivers.txt)"
    VK_LAYER_PATH=$drivers PALPATE_TESTS_VALIDATE=core \
      tests 'under a current validation layer' dev -L gpu -R "$(paste -sd '|' tests/other_drivers.txt)"
  else
    skipped+=('on SwiftShader, and under a current validation layer: third_party/drivers.sh gave none')
  fi
fi
tests 'all' dev

if missing=$(bash third_party/windows.sh --check 2>&1); then
  leg 'build for Windows' build windows --target palpate windows_tests && built+=' windows'
  xvfb-run -a bash third_party/wine.sh wineboot > /dev/null  # its own folder is made by one program, not by several at once
  around=(xvfb-run -a)
  PALPATE_TESTS_VALIDATE=0 tests 'for Windows, under wine' windows -R '^(core|io|haptics|session|gpu)\.' \
    -E '^gpu\.command_list$'  # which has a validation of its own
  leg 'a session for Windows, under wine' bash tests/windows_session.sh || true
else
  skipped+=("for Windows: $missing")
fi

echo
[ ${#skipped[@]} -eq 0 ] || printf 'run.sh: skipped: %s\n' "${skipped[@]}"
if [ ${#failed[@]} -eq 0 ]; then
  echo "run.sh: every leg passed, in $SECONDS s"
else
  printf 'run.sh: failed: %s\n' "${failed[@]}"
  exit 1
fi
