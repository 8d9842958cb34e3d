# What has been compiled once is not compiled again, in this tree or in another one of the same files: ccache, where it is
# installed. Paths below the tree are taken as relative to it; precompiled headers are compared by their content. With
# CCACHE_DISABLE=1 every file is compiled, to measure that. What a file holds is looked at once and not for each file that
# includes it, as long as its inode and times stay as they are (the inode cache): a precompiled header of 100 MB takes ten
# times as long to read as all else that a hit costs.
find_program(PALPATE_CCACHE ccache)
mark_as_advanced(PALPATE_CCACHE)
if(PALPATE_CCACHE)
  foreach(language C CXX)
    set(CMAKE_${language}_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
        CCACHE_INODECACHE=1 CCACHE_SLOPPINESS=pch_defines,time_macros ${PALPATE_CCACHE})
  endforeach()
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
  endif()
endif()
