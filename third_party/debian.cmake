# `cpack --preset packages`: Debian packages libpalpate0, libpalpate-dev, palpate and python3-palpate, for the Debian
# release of this machine, which depend on the libraries they are linked to; and an archive of all of them.
set(files ${CMAKE_CURRENT_LIST_DIR}/debian)
set(made ${CMAKE_BINARY_DIR}/debian)

# The documentation of every package, with the notices of compiled-in and linked libraries from their Debian packages.
set(notices "")
foreach(package libglm-dev nlohmann-json3-dev libnanoflann-dev libstb-dev zlib1g-dev libvulkan-volk-dev
                libvulkan-dev libcli11-dev
                libimgui-dev libfmt-dev libhidapi-dev libboost1.74-dev libglfw3-dev libpugixml-dev
                libdraco-dev libmeshoptimizer-dev pybind11-dev cyclonedds-dev libssl-dev)
  if(EXISTS /usr/share/doc/${package}/copyright)
    file(READ /usr/share/doc/${package}/copyright text)
    string(APPEND notices "==== ${package}\n\n${text}\n\n")
  else()
    string(APPEND notices "==== ${package}: its notice was missing on the build machine\n\n")
  endif()
endforeach()
file(WRITE ${made}/third-party-notices "${notices}")
string(TIMESTAMP today "%a, %d %b %Y 00:00:00 +0000" UTC)
configure_file(${files}/changelog.in ${made}/changelog @ONLY)
execute_process(COMMAND gzip -9nc ${made}/changelog OUTPUT_FILE ${made}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
foreach(pair "library;libpalpate0" "dev;libpalpate-dev" "program;palpate" "python;python3-palpate")
  list(GET pair 0 component)
  list(GET pair 1 package)
  install(FILES ${files}/copyright ${made}/changelog.gz DESTINATION share/doc/${package} COMPONENT ${component})
  set(overrides ${files}/lintian-overrides.in)
  if(component STREQUAL library)
    list(APPEND overrides ${files}/lintian-overrides-library.in)
  endif()
  set(overridden "")
  foreach(file ${overrides})
    file(READ ${file} text)
    string(CONFIGURE "${text}" text @ONLY)
    string(APPEND overridden "${text}")
  endforeach()
  file(WRITE ${made}/${package} "${overridden}")
  install(FILES ${made}/${package} DESTINATION share/lintian/overrides COMPONENT ${component})
  if(NOT component STREQUAL dev)  # it contains only palpate's headers
    install(FILES ${made}/third-party-notices DESTINATION share/doc/${package} COMPONENT ${component})
  endif()
endforeach()

if(TARGET palpate)
  # The manual is generated from the program's help.
  add_custom_command(OUTPUT ${made}/palpate.1.gz DEPENDS palpate ${files}/manual.sh VERBATIM
    COMMAND bash ${files}/manual.sh $<TARGET_FILE:palpate> ${PROJECT_VERSION} ${made}/palpate.1.gz)
  add_custom_target(palpate_manual ALL DEPENDS ${made}/palpate.1.gz)
  install(FILES ${made}/palpate.1.gz DESTINATION share/man/man1 COMPONENT program)
  install(FILES ${files}/palpate.bash RENAME palpate DESTINATION share/bash-completion/completions COMPONENT program)
  install(FILES ${files}/palpate.zsh RENAME _palpate DESTINATION share/zsh/vendor-completions COMPONENT program)
  install(FILES ${files}/palpate.desktop DESTINATION share/applications COMPONENT program)
  string(TIMESTAMP release_day "%Y-%m-%d" UTC)
  configure_file(${files}/palpate.metainfo.xml.in ${made}/palpate.metainfo.xml @ONLY)
  install(FILES ${made}/palpate.metainfo.xml DESTINATION share/metainfo COMPONENT program)
  install(FILES ${files}/palpate.svg DESTINATION share/icons/hicolor/scalable/apps COMPONENT program)
  install(FILES ${files}/palpate.xml DESTINATION share/mime/packages COMPONENT program)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/70-palpate.rules DESTINATION lib/udev/rules.d COMPONENT program)
endif()

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_LIST_DIR}/archive.cmake)
set(CPACK_PACKAGE_FILE_NAME palpate-${PROJECT_VERSION}-linux-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_PACKAGE_CONTACT "The owner of palpate <palpate@localhost>")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL "")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "feel, see and sculpt point clouds in real time")
set(for_a_gpu "libvulkan1, mesa-vulkan-drivers | vulkan-icd")  # loaded at run time; without them the CPU answers
set(no_licence "No licence has been chosen by the owner of palpate.")

# package(COMPONENT NAME SECTION TEXT DEPENDS)
macro(package component name section text depends)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${text}\n.\n${no_licence}")
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${CPACK_DEBIAN_${upper}_DESCRIPTION}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
endmacro()
if(TARGET palpate)
  package(program palpate science
          "The program: a point cloud of millions of points is felt with a haptic\nstylus or a mouse, seen and \
sculpted, on any Vulkan GPU or without one."
          "fonts-dejavu-core")
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "${for_a_gpu}")
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS
      "fonts-noto-cjk | fonts-droid-fallback, python3-palpate, vulkan-validationlayers")
endif()
if(TARGET palpate_library)
  package(library libpalpate0 libs "The shared library: haptic sessions for other programs, with a C interface." "")
  set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
  set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${files}/triggers)
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "${for_a_gpu}")
  package(dev libpalpate-dev libdevel
          "Development files: headers for C and C++, and files for CMake and\npkg-config."
          "libpalpate0 (= ${PROJECT_VERSION})")
endif()
if(TARGET palpate_python)
  get_property(python_version GLOBAL PROPERTY PALPATE_PYTHON_VERSION)
  package(python python3-palpate python
          "The module for Python 3: NumPy arrays in, forces, points, pictures, meshes out."
          "libpalpate0 (>= ${PROJECT_VERSION}), python3 (>= ${python_version}), python3 (<< ${python_version}.999), \
python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${files}/postinst;${files}/prerm")
endif()
include(CPack)
