# Rooms of the host: without Vulkan, and testable with sanitizers.
if(NOT WIN32)
  palpate_tests(house LINKS palpate::core)
  # The files of the host's rooms, for the test that they do not include Vulkan.
  set(host_sources "")
  foreach(room core cloud io motion spatial_host contact_host edit_host touch_host matter mesh_host render_host select
               haptics session sharing study_host haptics_study)
    if(NOT TARGET palpate_${room})
      continue()  # an annex that is not built
    endif()
    get_target_property(sources palpate_${room} SOURCES)
    get_target_property(folder palpate_${room} SOURCE_DIR)
    foreach(source ${sources})
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder})
      cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
      string(APPEND host_sources "${source}\n")
    endforeach()
  endforeach()
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/host_sources.txt CONTENT "${host_sources}" @ONLY)
  set_source_files_properties(house/host_test.cpp PROPERTIES COMPILE_DEFINITIONS
                              PALPATE_HOST_SOURCES="${CMAKE_CURRENT_BINARY_DIR}/host_sources.txt")
  palpate_entry(house.measurements COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/house/measurements.py)
endif()
palpate_tests(core LINKS palpate::core)
palpate_test_program(labelled_cases programs/labelled_cases.cpp palpate::core)
target_sources(labelled_cases PRIVATE $<TARGET_OBJECTS:tests_main>)
add_dependencies(tests_core labelled_cases)
list(JOIN CMAKE_CROSSCOMPILING_EMULATOR " " emulator)  # runs programs of another architecture
set_source_files_properties(core/labels_linux_test.cpp PROPERTIES COMPILE_DEFINITIONS
                            PALPATE_LABELLED_CASES="${emulator} '$<TARGET_FILE:labelled_cases>'")
set_source_files_properties(core/last_words_linux_test.cpp PROPERTIES COMPILE_DEFINITIONS
                            PALPATE_EMULATOR="${emulator}")
palpate_tests(cloud LINKS palpate::io palpate::cloud)
if(TARGET third_party::draco AND TARGET third_party::meshoptimizer)
  palpate_tests(io LINKS palpate::io third_party::draco third_party::meshoptimizer)
else()
  palpate_tests(io LINKS palpate::io WITHOUT gltf_packed)
endif()
palpate_tests(motion LINKS palpate::motion palpate::io)
palpate_tests(spatial LINKS palpate::spatial_host)
palpate_tests(contact LINKS palpate::touch_host)
palpate_tests(select LINKS palpate::select palpate::io)
palpate_tests(edit LINKS palpate::edit_host)
# The cases of these run on the CPU here and on the GPU in tests_touch_gpu (touch/back_end.hpp).
set(both_back_ends touch/accumulate_test.cpp touch/bad_input_test.cpp touch/hands_test.cpp touch/limbs_test.cpp
    touch/locked_test.cpp touch/moving_test.cpp touch/offered_test.cpp touch/press_test.cpp touch/replace_test.cpp
    touch/stream_test.cpp touch/thin_parts_test.cpp touch/trench_test.cpp)
palpate_tests(touch LINKS palpate::touch_host palpate::io WITH touch/cpu_back_end.cpp allocation_count.cpp)
palpate_tests(mesh LINKS palpate::mesh_host)
palpate_tests(haptics LINKS palpate::haptics WITH fake_devices/fake_haply.cpp allocation_count.cpp)
palpate_system_sources(tests_haptics fake_devices/mapped_note)
add_dependencies(tests_haptics fake_drivers)
# The cases of these run on the CPU here and on the GPU in tests_session_gpu (session/backend_kind.hpp).
set(both_session_back_ends session/command_storm_test.cpp session/masked_session_test.cpp
    session/symmetric_strokes_test.cpp session/stroke_layers_test.cpp)
palpate_tests(session LINKS palpate::session WITH session/cpu_backend_kind.cpp fake_devices/fake_haply.cpp)
palpate_system_sources(tests_session fake_devices/mapped_note)
add_dependencies(tests_session fake_drivers)
if(PALPATE_SIMULATION)
  # These run on the CPU here and on the GPU in tests_matter_gpu (matter/on_matter.hpp).
  file(GLOB matter_truths RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} matter/*_truths_test.cpp)
  palpate_tests(matter LINKS palpate::matter WITH matter/matter_on_cpu.cpp allocation_count.cpp)
  # Lanes of eight floats are passed between its functions alone.
  set_source_files_properties(matter/neighbours_test.cpp PROPERTIES COMPILE_OPTIONS "-Wno-psabi")
  palpate_tests(simulation LINKS palpate::session)
endif()
if(PALPATE_STUDY)
  palpate_tests(study LINKS palpate::haptics_study palpate::study_host)
endif()
# A Haply service for programs of any system (windows_packages.sh).
palpate_test_program(haply_service programs/haply_service.cpp palpate::haptics)
target_sources(haply_service PRIVATE fake_devices/fake_haply.cpp)
palpate_system_sources(haply_service surroundings)
# The program in the README.
palpate_test_program(embedding programs/embedding.cpp palpate::session)
add_dependencies(tests_session embedding)
string(STRIP "${emulator} $<TARGET_FILE:embedding>" embedding)
set_source_files_properties(session/embedding_linux_test.cpp PROPERTIES COMPILE_DEFINITIONS
                            PALPATE_EMBEDDING="${embedding}")
