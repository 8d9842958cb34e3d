# Shared sessions, on a network within this machine.
if(TARGET third_party::crypto AND TARGET third_party::pugixml)
  set(crypto third_party::crypto)  # also used by a test, to sign
else()
  set(without_security security)  # this build cannot encrypt sessions
endif()
if(NOT PALPATE_SIMULATION)
  set(without_simulation joined_matter)
endif()
palpate_tests(sharing LINKS palpate::sharing palpate::session ${crypto}
              WITHOUT ${without_security} ${without_simulation})

# A hostile program; the tests measure its effects.
set(made ${CMAKE_CURRENT_BINARY_DIR}/generated/haptics/sharing)
file(MAKE_DIRECTORY ${made})
add_custom_command(OUTPUT ${made}/hostile.c ${made}/hostile.h DEPENDS programs/hostile.idl WORKING_DIRECTORY ${made}
                   VERBATIM COMMAND ${PALPATE_IDLC} -t ${CMAKE_CURRENT_SOURCE_DIR}/programs/hostile.idl)
add_library(hostile_types STATIC ${made}/hostile.c ${made}/hostile.h)
target_include_directories(hostile_types SYSTEM PUBLIC ${CMAKE_CURRENT_BINARY_DIR}/generated)
target_link_libraries(hostile_types PUBLIC CycloneDDS::ddsc)
palpate_test_program(hostile_side programs/hostile_side.cpp palpate::sharing hostile_types)
target_sources(hostile_side PRIVATE thread_sanitizer.cpp)
set_source_files_properties(sharing/hostile_network_test.cpp PROPERTIES COMPILE_DEFINITIONS
                            PALPATE_HOSTILE_SIDE="$<TARGET_FILE:hostile_side>")

get_property(python GLOBAL PROPERTY PALPATE_PYTHON3)
set(scripts ${CMAKE_CURRENT_SOURCE_DIR}/sharing)
if(python)
  set(sharing ${PROJECT_SOURCE_DIR}/haptics/sharing)
  palpate_entry(sharing.ros_type_hashes COMMAND ${python} ${scripts}/ros_type_hashes.py ${sharing}/ros.idl
                                                ${sharing}/ros_messages.cpp)
endif()
if(NOT TARGET palpate OR NOT python OR CMAKE_CROSSCOMPILING)
  return()
endif()

# Third-party programs on the same network, if installed; each skip is printed with its reason.
set(room_label program)
palpate_test_program(ros_listener programs/ros_listener.cpp palpate::sharing)
set(foreign ${python} ${scripts}/foreign_programs.py)
foreach(program dissected decoded)
  palpate_entry(sharing.${program} COMMAND ${foreign} ${program} $<TARGET_FILE:palpate> $<TARGET_FILE:ros_listener>)
endforeach()
find_package(fastcdr QUIET)
find_package(fastrtps QUIET)
if(TARGET fastrtps AND TARGET fastcdr)
  palpate_test_program(fastdds_peer programs/fastdds_peer.cpp fastrtps fastcdr)  # contains no code of palpate
  set(peer $<TARGET_FILE:fastdds_peer>)
else()
  message(STATUS "Without Fast DDS (libfastrtps-dev, libfastcdr-dev): sharing.fastdds is skipped")
endif()
palpate_entry(sharing.fastdds COMMAND ${foreign} fastdds $<TARGET_FILE:palpate> ${peer})
palpate_entry(sharing.beside_ddsperf COMMAND bash ${scripts}/beside_ddsperf.sh $<TARGET_FILE:palpate>
                                             $<TARGET_FILE:ros_listener> 1)
# Links that delay, lose and reorder: the leg `links` of the full tier.
set(room_label links)
foreach(link 20,1 20,1,15)
  string(REPLACE "," "_" name ${link})
  palpate_entry(sharing.link_${name} LABELS waits
                COMMAND ${python} ${scripts}/link_table.py $<TARGET_FILE:palpate> --short ${link})
endforeach()
palpate_entry(sharing.slow_link LABELS waits COMMAND bash ${scripts}/over_slow_link.sh $<TARGET_FILE:palpate>)
set(room_label host)
