#!/usr/bin/env bash
# Installs what is missing, builds with validation and warnings as errors, and runs every test headless: on lavapipe,
# or on the GPU that PALPATE_GPU names. What runs on the CPU alone runs again under AddressSanitizer and UBSan, the
# servo loop under ThreadSanitizer, and on lavapipe the GPU passes, room by room, with one driver thread, which orders
# atomics differently. Ends with ctest's summary.
set -euo pipefail
cd "$(dirname "$0")/.."

bash third_party/install.sh
export PALPATE_GPU=${PALPATE_GPU:-llvmpipe}

cmake --preset dev > /dev/null
cmake --build --preset dev
cmake --preset asan > /dev/null
cmake --build --preset asan --target host_tests
cmake --preset tsan > /dev/null
cmake --build --preset tsan --target tests_haptics

ctest --preset asan -L host -j 2 --no-tests=error
ctest --preset tsan -R '^haptics\.' -j 2 --no-tests=error
if [ "$PALPATE_GPU" = llvmpipe ]; then
  LP_NUM_THREADS=1 ctest --preset dev -R '^(gpu|spatial|contact|edit|mesh)\.' -j 2 --no-tests=error
fi
ctest --preset dev -j 2 --no-tests=error
