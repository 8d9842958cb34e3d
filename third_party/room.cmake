# palpate_system_sources(TARGET names…): adds system-dependent sources, which have one header and a file for each
# system: NAME_linux.cpp, NAME_windows.cpp. The macros of <windows.h> (near, far) conflict with names in other files.
function(palpate_system_sources target)
  if(WIN32)
    list(TRANSFORM ARGN APPEND _windows.cpp)
    set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  else()
    list(TRANSFORM ARGN APPEND _linux.cpp)
  endif()
  target_sources(${target} PRIVATE ${ARGN})
endfunction()

# palpate_room(NAME SOURCES files… SYSTEM names… LINKS rooms-and-libraries…)
# One static library per room, which others link as palpate::NAME. Include paths start at the top of the tree
# ("engine/gpu/device.hpp"), so that readers and tests/house/architecture_test.cpp see a header's room.
function(palpate_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;SYSTEM;LINKS" ${ARGN})
  add_library(palpate_${name} STATIC ${ROOM_SOURCES})
  palpate_system_sources(palpate_${name} ${ROOM_SYSTEM})
  add_library(palpate::${name} ALIAS palpate_${name})
  target_link_libraries(palpate_${name} PUBLIC ${ROOM_LINKS} PRIVATE palpate_build_options)
  target_include_directories(palpate_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  palpate_unite(palpate_${name})
  if(name STREQUAL core)
    palpate_precompile(palpate_core)
  else()
    palpate_precompile(palpate_${name} REUSE_FROM palpate_core)
  endif()
endfunction()

# palpate_precompile(TARGET headers… | REUSE_FROM TARGET): precompiles these headers and those of other libraries that
# nearly every file includes. Only with PALPATE_PRECOMPILE: builds without it detect files that do not include what they
# use.
function(palpate_precompile target)
  if(NOT PALPATE_PRECOMPILE)
    return()
  elseif(ARGV1 STREQUAL REUSE_FROM)
    target_precompile_headers(${target} ${ARGN})
    return()
  endif()
  target_precompile_headers(${target} PRIVATE ${ARGN}
    <fmt/format.h> <glm/ext/quaternion_double.hpp> <glm/ext/quaternion_geometric.hpp> <glm/geometric.hpp>
    <glm/mat4x4.hpp> <glm/vec2.hpp> <glm/vec3.hpp> <glm/vec4.hpp> <algorithm> <array> <atomic> <charconv> <chrono>
    <cmath> <condition_variable> <deque> <filesystem> <fstream> <functional> <map> <memory> <mutex> <numbers> <optional>
    <random> <set> <span> <sstream> <string> <thread> <variant> <vector>)
endfunction()

# palpate_unite(TARGET): compiles several files as one. palpate's headers are then read less often: a cold build takes
# half the time. Files with their own flags are compiled separately. Names in anonymous namespaces must therefore be
# unique in a target. Only with PALPATE_PRECOMPILE; the other presets compile each file by its own includes.
function(palpate_unite target)
  if(PALPATE_PRECOMPILE)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${PALPATE_FILES_AT_ONCE})
  endif()
endfunction()
set(PALPATE_FILES_AT_ONCE 6 CACHE STRING "Number of files compiled as one with PALPATE_PRECOMPILE")
mark_as_advanced(PALPATE_FILES_AT_ONCE)
