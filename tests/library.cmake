# The library as another program has it: only what it exports is linked.
set(library_links palpate::palpate palpate::core)
add_library(own_law MODULE library/half_as_stiff.c)
target_link_libraries(own_law PRIVATE palpate::palpate palpate_build_options)
palpate_tests(library LINKS ${library_links})
set_source_files_properties(library/touch_test.cpp PROPERTIES COMPILE_DEFINITIONS
                            PALPATE_OWN_LAW="$<TARGET_FILE:own_law>")
add_dependencies(tests_library own_law)

get_property(python GLOBAL PROPERTY PALPATE_PYTHON3)
set(room_label program)
if(NOT PALPATE_SANITIZE AND NOT CMAKE_CROSSCOMPILING)
  palpate_entry(library.consumers
                COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/consumers/run.sh ${CMAKE_BINARY_DIR} ${python})
endif()
if(TARGET palpate_python AND PALPATE_VULKAN)
  add_dependencies(all_tests palpate_python)
  set(modules ${CMAKE_BINARY_DIR}/python)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/python/test_*.py)
  foreach(file ${files})
    cmake_path(GET file STEM name)
    string(REGEX REPLACE "^test_" "" name ${name})
    palpate_entry(python.${name} LABELS first COMMAND ${python} -m pytest -q -rs -p no:cacheprovider
                                                      -o faulthandler_timeout=300 ${file})
    list(APPEND entries python.${name})
  endforeach()
  palpate_entry(python.types COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/python/types.sh ${python} ${modules})
  set(surroundings PYTHONPATH=${modules} PYTHONDONTWRITEBYTECODE=1 PALPATE_OWN_LAW=$<TARGET_FILE:own_law>
                   PALPATE_PROGRAM=$<$<BOOL:${PALPATE_APPS}>:${CMAKE_BINARY_DIR}/palpate>)
  set_tests_properties(${entries} python.types PROPERTIES ENVIRONMENT "${surroundings}")
endif()
set(room_label host)
