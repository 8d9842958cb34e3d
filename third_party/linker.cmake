# lld, where it is installed, takes half the time of the compiler's own linker.
find_program(PALPATE_LD_LLD ld.lld)
mark_as_advanced(PALPATE_LD_LLD)
if(PALPATE_LD_LLD AND NOT CMAKE_CROSSCOMPILING)
  add_link_options($<$<LINK_LANG_AND_ID:CXX,GNU,Clang>:-fuse-ld=lld> $<$<LINK_LANG_AND_ID:C,GNU,Clang>:-fuse-ld=lld>)
endif()
