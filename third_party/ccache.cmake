# ccache, if it is installed: a file is compiled once, for this tree and for others with the same files. Paths below the
# tree are taken as relative to it; precompiled headers are compared by their content. CCACHE_DISABLE=1 compiles every
# file, to measure that. The inode cache reads a file once and not for each file that includes it, as long as its inode
# and times stay the same: a precompiled header of 100 MB takes ten times as long to read as the rest of a hit.
find_program(PALPATE_CCACHE ccache)
mark_as_advanced(PALPATE_CCACHE)
if(PALPATE_CCACHE)
  foreach(language C CXX)
    set(CMAKE_${language}_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
        CCACHE_NOHASHDIR=1 CCACHE_INODECACHE=1 CCACHE_SLOPPINESS=pch_defines,time_macros ${PALPATE_CCACHE})
  endforeach()
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
  endif()
endif()
