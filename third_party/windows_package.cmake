# `cpack --preset windows`: a zip of one folder, and an installer (NSIS) of the same files: the program with its font,
# the library, headers, import library and CMake package, examples, documents and licences.
set(documents ${CMAKE_INSTALL_DATADIR}/doc/palpate)
install(FILES /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES ${CMAKE_CURRENT_LIST_DIR}/windows/first_steps.txt DESTINATION . RENAME "First steps.txt")
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/apps/REFERENCE.md DESTINATION ${documents})
install(FILES ${CMAKE_CURRENT_LIST_DIR}/debian/copyright DESTINATION ${documents} RENAME copyright.txt)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/build/windows-libraries/prefix/licences DESTINATION ${documents})
set(CPACK_GENERATOR ZIP NSIS)
set(CPACK_PACKAGE_FILE_NAME palpate-${PROJECT_VERSION}-windows-x86_64)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR})
set(CPACK_MONOLITHIC_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR}/windows)  # the installer: NSIS.template.in
set(CPACK_NSIS_MUI_ICON ${CMAKE_BINARY_DIR}/apps/generated/palpate.ico)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_SUPPORTED_TYPES "")  # for "Open with": the types of the desktop entry
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/debian/palpate.xml patterns REGEX "\"\\*\\.[a-z0-9]+\"")
foreach(pattern ${patterns})
  string(REGEX REPLACE ".*\"\\*(.*)\".*" "\\1" ending ${pattern})
  string(APPEND CPACK_SUPPORTED_TYPES "  WriteRegStr HKCU \"\${OPEN_WITH}\\SupportedTypes\" \"${ending}\" \"\"\n")
endforeach()
set(CPACK_NSIS_EXECUTABLE_PRE_ARGUMENTS -V2)  # warnings and errors
include(CPack)
file(COPY /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf DESTINATION ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
