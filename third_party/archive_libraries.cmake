# Runs in CPack, once the files of the archive are in their folder.
execute_process(COMMAND python3 ${CMAKE_CURRENT_LIST_DIR}/bundle.py ${CPACK_TEMPORARY_INSTALL_DIRECTORY}
                        ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/lib/palpate
                COMMAND_ERROR_IS_FATAL ANY)
