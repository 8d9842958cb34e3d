# Windows, by mingw: the Windows version of the headers, binary mode for all files, and the stack size that Linux gives
# a program.
target_compile_definitions(palpate_build_options INTERFACE _WIN32_WINNT=0x0A00 WIN32_LEAN_AND_MEAN NOMINMAX)
execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=binmode.o
                OUTPUT_VARIABLE binmode OUTPUT_STRIP_TRAILING_WHITESPACE)
set(CMAKE_EXE_LINKER_FLAGS "${CMAKE_EXE_LINKER_FLAGS} ${binmode} -Wl,--stack,8388608" PARENT_SCOPE)
