#!/usr/bin/env bash
# Installs missing dependencies, builds, and runs the tests headless, on lavapipe or on the GPU that PALPATE_GPU names.
#   bash tests/run.sh              the quick tier: what every change runs
#   bash tests/run.sh --full       the quick tier and all other legs
#   bash tests/run.sh --leg NAME   one leg; --list names them
#   bash tests/run.sh --ci         the quick tier, then other legs in turn while less than 25 minutes have passed
set -euo pipefail
cd "$(dirname "$0")/.."
export PALPATE_GPU=${PALPATE_GPU:-llvmpipe} PALPATE_TESTS_RESULTS=$PWD/build/tests/cases

legs=(plain windows searched one_thread fuzz lint links thread swiftshader layer mutations recipes truths address arm64
      packages)
build() { cmake --preset "$1" > /dev/null && cmake --build --preset "$1" --target "${@:2}"; }  # PRESET TARGETS...
tests() {  # PRESET [CTEST OPTIONS...]: two slots per core, since some entries sleep (tests/CMakeLists.txt)
  ctest --preset "$1" -j $((2 * $(nproc) + 2)) --no-tests=error "${@:2}"
}
release() { build release palpate all_tests && PALPATE_TESTS_VALIDATE=${validate:-core} tests release "$@"; }
skip() { echo "skipped: ${*//$'\n'/; }"; return 77; }
drivers() { drivers=$(bash third_party/drivers.sh 2>&1) || skip "$drivers"; }

quick() { release -LE '^links$'; }
address() { build asan all_tests && tests asan; }                          # AddressSanitizer and UBSan, without Vulkan
truths() { PALPATE_TESTS_ONLY=full release -L '^(host|gpu|program)$'; }    # figures that take minutes
searched() { validate=full release -L '^gpu$'; }                           # GPU-assisted validation of every access
one_thread() { LP_NUM_THREADS=1 LP_NATIVE_VECTOR_WIDTH=128 validate=0 release -L '^gpu$'; }  # and subgroups of four
plain() { build plain palpate all_tests && PALPATE_TESTS_VALIDATE=core tests plain; }  # the core, without the annexes
links() { release -L '^links$'; }                                          # links that delay, lose and reorder
thread() {  # without what measures rates, which a sanitizer does not reach
  build tsan tests_haptics tests_session tests_library tests_sharing tests_core haply_service hostile_side &&
    tests tsan -E '^(library\.(devices|fork|stopped_service)_linux|sharing\.(far_cloud|hostile_network))$' \
      -R '^((haptics|session|library|sharing)\.|core\.(latest_value|worker_team|parallel.*|background_task)$)'
}
portable() { PALPATE_TESTS_ONLY=portable release -L '^gpu$'; }
swiftshader() { drivers && VK_DRIVER_FILES=$drivers/swiftshader.json PALPATE_GPU=SwiftShader validate=0 portable; }
layer() { drivers && VK_LAYER_PATH=$drivers portable; }                    # a current validation layer
lint() { bash tests/lint.sh; }
mutations() {  # in place if nothing is uncommitted, otherwise in a worktree built from scratch
  local here=
  ! git diff --quiet HEAD || here=--here
  build release palpate all_tests && bash tests/mutations.sh $here
}
recipes() { bash tests/recipes.sh; }                                       # a dummy by the files that a recipe names
fuzz() { build asan tests_io && PALPATE_FUZZ_S=600 build/asan/tests_io --source-file='*reader_fuzz*'; }
windows() {
  local missing
  missing=$(bash third_party/windows.sh --check 2>&1) || { skip "$missing"; return; }
  build release palpate haply_service && build windows all all_tests &&
    xvfb-run -a bash third_party/wine.sh wineboot > /dev/null
  PALPATE_TESTS_VALIDATE=0 xvfb-run -a ctest --preset windows -j 2 -R '^(core|io|haptics|session|library|gpu)\.' &&
    bash tests/windows_session.sh && cpack --preset windows > /dev/null && bash tests/windows_packages.sh
}
packages() {  # the Debian packages, the archive and the wheel; with root and debootstrap also in a bare Debian
  local made=build/packages/packages
  build packages all && cpack --preset packages > /dev/null && bash tests/library/built_packages.sh $made || return
  [ "$(id -u)" -eq 0 ] && command -v debootstrap > /dev/null || { skip 'bare Debian: no root or debootstrap'; return; }
  PYTHONPATH=apps/python python3 -c "import wheel_backend as wheel
wheel.build_wheel('$made', {'build': 'build/packages'})" && bash third_party/try_packages.sh
}
arm64() { bash third_party/install.sh --arm64 && bash third_party/arm64.sh; }

rows=() failed=
run() {  # LEG: a failure does not stop the next one
  local leg=$1 begin=$SECONDS code=0 log=build/tests/$1.log result=passed
  mkdir -p build/tests && rm -f "$PALPATE_TESTS_RESULTS"
  printf '\n== %s\n' "$leg"
  "$leg" 2>&1 | tee "$log" || code=${PIPESTATUS[0]}
  cp "$PALPATE_TESTS_RESULTS" "build/tests/$leg.cases" 2> /dev/null || : > "build/tests/$leg.cases"
  case $code in 0) ;; 77) result=skipped ;; *) result=FAILED failed+=" $leg" ;; esac
  rows+=("$(awk -F '\t' -v leg="$leg" -v result="$result" -v s=$((SECONDS - begin)) '
    $1 == "passed" || $1 == "failed" { ++cases } $1 == "skipped" { ++skips }
    END { printf "%-12s %-8s %5d cases %5d s %4d skipped", leg, result, cases, s, skips }' "build/tests/$leg.cases")")
}
summary() {  # LEGS...
  local leg
  printf '\n%s\n' "${rows[@]}"
  for leg in "$@"; do
    { grep -hE '^ *second try: |^skipped: |\((Failed|Timeout)\)$| ERROR: ' "build/tests/$leg.log" || true
      awk -F '\t' '$1 == "skipped" { print $5 ": " $6 }' "build/tests/$leg.cases"; } | sort -u | sed "s/^/$leg: /"
  done
  if [[ " $* " == *' quick '* ]] && [ -s build/tests/quick.cases ]; then
    echo 'The ten dearest cases of the quick tier, in seconds of a core (budget: 2, with whole programs 10):'
    grep -v '^skipped' build/tests/quick.cases | sort -t $'\t' -k 2,2nr | head -n 10 | cut -f 2,5,6 || true
  fi
  [ -z "$failed" ] || { echo "run.sh: failed:$failed"; exit 1; }
  echo "run.sh: every leg passed, in $SECONDS s"
}

case "${1:-}" in
  '') chosen=(quick) ;;
  --full) chosen=(quick "${legs[@]}") ;;
  --leg) chosen=("${2:?run.sh: --leg takes a name: quick ${legs[*]}}") ;;
  --ci) chosen=(quick) ;;
  --list) printf '%s\n' quick "${legs[@]}"; exit ;;
  *) sed -n '3,6s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac
bash third_party/install.sh
for leg in "${chosen[@]}"; do run "$leg"; done
if [ "${1:-}" = --ci ]; then
  first=$(git rev-list --count HEAD)
  for k in "${!legs[@]}"; do
    [ "$SECONDS" -lt 1500 ] || break
    leg=${legs[(first + k) % ${#legs[@]}]}
    run "$leg"
    chosen+=("$leg")
  done
fi
summary "${chosen[@]}"
