# NVIDIA's compiler, for the CUDA back end (engine/cuda) of PALPATE_STUDY only: without that option, or if the compiler
# is missing, PALPATE_HAS_CUDA is off and everything else is built as usual. The runtime is linked statically and opens
# the driver at its first use, so the program starts on machines without a driver. Sanitizers and the CUDA driver
# require the same addresses.
set(PALPATE_HAS_CUDA OFF)
if(PALPATE_STUDY AND (PALPATE_CUDA STREQUAL "ON" OR (PALPATE_CUDA STREQUAL "AUTO" AND NOT PALPATE_SANITIZE)))
  find_program(PALPATE_NVCC nvcc HINTS $ENV{CUDA_HOME}/bin $ENV{CUDA_PATH}/bin /usr/local/cuda/bin)
  if(PALPATE_NVCC)
    set(PALPATE_HAS_CUDA ON)
  elseif(PALPATE_CUDA STREQUAL "ON")
    message(FATAL_ERROR "PALPATE_CUDA is ON, but nvcc was not found; install the CUDA toolkit, or set PALPATE_NVCC")
  endif()
endif()

if(PALPATE_HAS_CUDA)
  if(NOT DEFINED CMAKE_CUDA_COMPILER)
    set(CMAKE_CUDA_COMPILER ${PALPATE_NVCC})
  endif()
  if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
    set(CMAKE_CUDA_ARCHITECTURES 90)
  endif()
  enable_language(CUDA)
  set(CMAKE_CUDA_STANDARD 20)
  if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake 3.25 does not know that nvcc supports it
    set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
    set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
  endif()
  find_package(CUDAToolkit REQUIRED)
endif()
message(STATUS "CUDA back end: ${PALPATE_HAS_CUDA}")
