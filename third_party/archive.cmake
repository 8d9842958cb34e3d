# CPack reads this for each kind of package. The archive can be unpacked anywhere: it contains the libraries that the
# program and libpalpate need, except for the runtimes of C and C++ and for the Vulkan loader.
if(CPACK_GENERATOR STREQUAL TGZ)
  set(CPACK_PACKAGING_INSTALL_PREFIX /)
  set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/archive_libraries.cmake)
endif()
