# palpate_room(NAME SOURCES files… LINKS rooms-and-libraries…)
# One static library per room, known to the others as palpate::NAME. Includes are written from the top of the tree
# ("engine/gpu/device.hpp"), so a reader sees which room a header belongs to, and so does the test of the arrows.
function(palpate_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINKS" ${ARGN})
  add_library(palpate_${name} STATIC ${ROOM_SOURCES})
  add_library(palpate::${name} ALIAS palpate_${name})
  target_link_libraries(palpate_${name} PUBLIC ${ROOM_LINKS} PRIVATE palpate_build_options)
  target_include_directories(palpate_${name} PUBLIC ${PROJECT_SOURCE_DIR})
endfunction()
