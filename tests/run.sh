#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors, and runs every test headless: what needs a GPU with validation
# on lavapipe, or on the GPU that PALPATE_GPU names, and what runs on the CPU alone without Vulkan, under AddressSanitizer
# and UBSan, the servo loop under ThreadSanitizer, too. On lavapipe GPU passes run again with one driver thread, which
# orders atomics differently, and subgroups of four in place of eight, between which a barrier is missed sooner (without
# validation, which the first leg has), and on another driver and under another validation layer, where those can be had. A leg that fails hides none behind it: all run, and the last lines name what
# failed. Where third_party/windows.sh has been, some tests run as programs for Windows, too, under wine; what is skipped
# is said, and so is what is held against the wall clock and passed only when it had the machine to itself.
set -euo pipefail
cd "$(dirname "$0")/.."

bash third_party/install.sh
export PALPATE_GPU=${PALPATE_GPU:-llvmpipe}

failed=()
skipped=()
alone=()
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
  local name=$1 preset=$2 log="build/$2/Testing/Temporary/LastTestsFailed.log" names late
  shift 2
  case " $built " in
    *" $preset "*) ;;
    *) failed+=("$name: not run, not built"); return ;;
  esac
  rm -f "$log"
  leg "$name" "${around[@]}" ctest --preset "$preset" -j 2 --no-tests=error "$@" && return
  [ -s "$log" ] || return 0
  names=$(sed 's/^[0-9]*://' "$log")
  # A machine that stands still for a moment fails what is held against the wall clock; nothing else is tried twice.
  late=$(ctest --preset "$preset" -N -L '^clock$' | sed -n 's/^ *Test *#[0-9]*: //p') || true
  if [ -z "$(grep -vxF "$late" <<< "$names")" ] &&
    "${around[@]}" ctest --preset "$preset" "$@" -R "^($(paste -sd '|' <<< "${names//./\\.}"))\$"; then
    unset 'failed[-1]'
    alone+=("$name: $(paste -sd ' ' <<< "$names")")
  else
    failed[-1]="$name: $(paste -sd ' ' <<< "$names")"
  fi
}

wait_beside() {  # NAME PRESET OPTIONS...: begins what waits for most of its time (label waits), which costs those beside it little
  beside=("$@")
  beside_job=
  case " $built " in *" $2 "*) ;; *) return 0 ;; esac
  beside_words=$(mktemp)
  # In a folder of its own: two runs of ctest in one would write each over what the other one says.
  rm -f "build/$2/tests/Testing/Temporary/LastTestsFailed.log"
  ctest --test-dir "build/$2/tests" -j 2 --no-tests=error --output-on-failure "${@:3}" > "$beside_words" 2>&1 &
  beside_job=$!
  trap 'kill "$beside_job" 2> /dev/null || true' EXIT
}

waited() {  # what came of it; whatever it is, it waited for a clock, so what failed has a second try, by itself
  local name="waiting, beside what is tried ${beside[0]}" preset=${beside[1]} again=("${beside[@]:2}") names
  if [ -z "$beside_job" ]; then
    failed+=("$name: not run, not built")
  elif leg "$name" waited_well; then
    rm -f "$beside_words"
  else
    unset 'failed[-1]'
    names=$(sed 's/^[0-9]*://' "build/$preset/tests/Testing/Temporary/LastTestsFailed.log" 2> /dev/null) || true
    [ -z "$names" ] || again=(-R "^($(paste -sd '|' <<< "${names//./\\.}"))\$")
    local failures=${#failed[@]}
    tests "waiting, ${beside[0]}" "$preset" "${again[@]}"
    [ ${#failed[@]} -ne "$failures" ] || alone+=("$name${names:+: $(paste -sd ' ' <<< "$names")}")
  fi
}

waited_well() {
  local code=0
  wait "$beside_job" || code=$?
  trap - EXIT
  cat "$beside_words"
  return $code
}

built=
leg 'build' build dev --target palpate gpu_tests && built+=' dev'
wait_beside 'with a GPU' dev -LE '^host$' -L '^waits$'
tests 'with a GPU' dev -LE '^(host|waits)$'
waited
leg 'build without Vulkan, for AddressSanitizer and UBSan' build asan --target host_tests && built+=' asan'
sanitized='without Vulkan, under AddressSanitizer and UBSan'
wait_beside "$sanitized" asan -L '^waits$'
tests "$sanitized" asan -L '^host$' -LE '^waits$'
waited
leg 'build for ThreadSanitizer' build tsan --target tests_haptics tests_core && built+=' tsan'
tests 'under ThreadSanitizer' tsan -R '^(haptics\.|core\.latest_value$)'
if [ "$PALPATE_GPU" = llvmpipe ]; then
  LP_NUM_THREADS=1 LP_NATIVE_VECTOR_WIDTH=128 PALPATE_TESTS_VALIDATE=0 \
    tests 'with one driver thread and subgroups of four' dev -C portable \
    -R '^(spatial|contact|edit|mesh|motion_gpu)\.(gpu|hash_compaction)$|^matter_gpu\.portable$'
  # A third driver and a current layer judge what the packaged ones let pass.
  if drivers=$(bash third_party/drivers.sh); then
    VK_DRIVER_FILES=$drivers/swiftshader.json PALPATE_GPU=SwiftShader PALPATE_TESTS_VALIDATE=0 \
      tests 'on SwiftShader' dev -C portable -L '^portable$'
    VK_LAYER_PATH=$drivers PALPATE_TESTS_VALIDATE=core \
      tests 'under a current validation layer' dev -C portable -L '^portable$'
  else
    skipped+=('on SwiftShader, and under a current validation layer: third_party/drivers.sh gave none')
  fi
fi

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
[ ${#alone[@]} -eq 0 ] || printf 'run.sh: passed at the second try, alone: %s\n' "${alone[@]}"
if [ ${#failed[@]} -eq 0 ]; then
  echo "run.sh: every leg passed, in $SECONDS s"
else
  printf 'run.sh: failed: %s\n' "${failed[@]}"
  exit 1
fi
