# Rooms on the GPU, and the program as a whole.
set(room_label gpu)
palpate_shaders(test_shaders gpu/shared_layout.comp gpu/add_one.comp gpu/spin.comp edit_gpu/brush_probe.comp)
palpate_shaders(test_watched PREFIX watched_ FLAGS -DPALPATE_WATCHED FILES gpu/spin.comp)
if(PALPATE_STUDY)
  set(watched palpate::watched)
else()
  set(without_watched workgroup_watch_linux)  # only the benches watch workgroups
endif()
palpate_tests(gpu LINKS palpate::spatial palpate::gpu palpate::test_shaders palpate::test_watched ${watched}
              WITHOUT ${without_watched})
palpate_tests(spatial_gpu LINKS palpate::spatial)
palpate_tests(proof_gpu LINKS palpate::proof)
palpate_tests(contact_gpu LINKS palpate::touch palpate::select)
if(PALPATE_STUDY)
  palpate_tests(study_gpu LINKS palpate::touch)
endif()
palpate_tests(motion_gpu LINKS palpate::motion_gpu)
palpate_tests(edit_gpu LINKS palpate::edit palpate::test_shaders WITH edit_gpu/edited_scene.cpp)
palpate_tests(mesh_gpu LINKS palpate::mesh WITH mesh_gpu/mesh_reference.cpp)
palpate_tests(touch_gpu LINKS palpate::touch palpate::render palpate::haptics WITH touch_gpu/gpu_back_end.cpp
              allocation_count.cpp ALSO ${both_back_ends})
palpate_tests(session_gpu LINKS palpate::session_gpu WITH session_gpu/gpu_backend_kind.cpp
              ALSO ${both_session_back_ends})
if(PALPATE_SIMULATION)
  palpate_tests(matter_gpu LINKS palpate::touch palpate::matter_gpu WITH matter_gpu/matter_on_gpu.cpp
                ALSO ${matter_truths})
endif()
palpate_tests(render LINKS palpate::render third_party::stb WITH render/splat_radius_reference.cpp
                      render/gaussian_reference.cpp render/water_reference.cpp)
if(TARGET palpate_library)
  palpate_tests(library_gpu LINKS ${library_links} third_party::volk)
endif()

if(WIN32)
  return()  # tests/windows_session.sh runs the program there
endif()

# A layer that loses the GPU at a given call, or limits it; next to the test programs.
add_library(palpate_lost_gpu MODULE lost_gpu/layer.cpp lost_gpu/made_up_gpu.cpp)
target_include_directories(palpate_lost_gpu PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(palpate_lost_gpu PRIVATE palpate_build_options)
set(lost_gpu_folder ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/lost_gpu)
set_target_properties(palpate_lost_gpu PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${lost_gpu_folder})
set(lost_gpu_library ./libpalpate_lost_gpu.so)
configure_file(lost_gpu/layer.json.in ${lost_gpu_folder}/layer.json @ONLY)
add_dependencies(all_tests palpate_lost_gpu)

if(PALPATE_HAS_CUDA)
  set(room_label cuda)
  palpate_tests(cuda LINKS palpate::cuda palpate::edit palpate::contact palpate::io)
endif()
if(NOT TARGET palpate)
  message(STATUS "Without the program (PALPATE_APPS=OFF): its tests are not built")
  return()
endif()
set(room_label program)
if(NOT TARGET tests_sharing)
  set(without_sharing onlookers ros ros_frames ros_scanner sharing_faults)  # they receive what the program sends
endif()
if(NOT PALPATE_STUDY)
  set(without_study bench[a-z_]* coexist)  # they run the benches
endif()
if(PALPATE_SIMULATION)
  set(without_simulation no_simulation)
else()
  set(without_simulation matter simulate)
endif()
palpate_tests(view LINKS palpate::session_gpu palpate::sharing glfw CLI11::CLI11
              WITH ${PROJECT_SOURCE_DIR}/apps/view/key_table.cpp ${PROJECT_SOURCE_DIR}/apps/view/help_search.cpp
              ${PROJECT_SOURCE_DIR}/apps/view/screen_places.cpp ${PROJECT_SOURCE_DIR}/apps/view/picture_pace.cpp)
palpate_tests(apps LINKS palpate::haptics palpate::io palpate::sharing third_party::stb
              WITH apps/program.cpp apps/result.cpp fake_devices/fake_haply.cpp
              WITHOUT ${without_sharing} ${without_study} ${without_simulation})
set(annexes "PALPATE_HAS_STUDY=$<BOOL:${PALPATE_STUDY}>;PALPATE_HAS_SIMULATION=$<BOOL:${PALPATE_SIMULATION}>")
set_source_files_properties(apps/program.cpp PROPERTIES COMPILE_DEFINITIONS
  "PALPATE_PROGRAM=\"$<TARGET_FILE:palpate>\";${annexes}")
add_dependencies(tests_apps palpate fake_drivers)
