# What is built to be tried is linked by lld where it is installed: half the linker's time, of some fifty programs. What
# users run is linked as the compiler does by itself. PALPATE_LLD=OFF does without.
option(PALPATE_LLD "Link with lld, where it is installed" OFF)
if(PALPATE_LLD)
  find_program(PALPATE_LD_LLD ld.lld)
  mark_as_advanced(PALPATE_LD_LLD)
  if(PALPATE_LD_LLD)
    add_link_options($<$<LINK_LANG_AND_ID:CXX,GNU,Clang>:-fuse-ld=lld> $<$<LINK_LANG_AND_ID:C,GNU,Clang>:-fuse-ld=lld>)
  else()
    message(STATUS "Without lld: linking takes twice as long")
  endif()
endif()
