# 64-bit Arm Linux (Jetson, Raspberry Pi, servers) from Linux on another processor: Debian's cross compiler, and the
# libraries that arm64.sh has unpacked. Tests run under qemu.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

get_filename_component(arm64_root "${CMAKE_CURRENT_LIST_DIR}/../build/arm64-libraries/root" ABSOLUTE)
set(CMAKE_FIND_ROOT_PATH "${arm64_root}" /usr/aarch64-linux-gnu)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
string(JOIN " " CMAKE_EXE_LINKER_FLAGS_INIT -Wl,-rpath-link,${arm64_root}/usr/lib/aarch64-linux-gnu
       -Wl,-rpath-link,${arm64_root}/lib/aarch64-linux-gnu)

set(CMAKE_CROSSCOMPILING_EMULATOR "qemu-aarch64;-L;${arm64_root}")
