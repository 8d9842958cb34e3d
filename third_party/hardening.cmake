# What dpkg-buildflags of Debian gives its packages. Tables of the loader are read-only in every build: that costs
# nothing later. The checks at run time are for packages, since they change the code of every file.
if(UNIX AND NOT APPLE)
  add_link_options(LINKER:-z,relro,-z,now)
endif()
if(PALPATE_HARDENED)
  add_compile_options($<$<COMPILE_LANGUAGE:C,CXX>:-fstack-protector-strong>)
  add_compile_definitions($<$<COMPILE_LANGUAGE:C,CXX>:_FORTIFY_SOURCE=2>)
endif()
