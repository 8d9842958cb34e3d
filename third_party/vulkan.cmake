# Libraries that only the GPU parts and the program need: Vulkan, the shader compiler, the window, the command line.
find_path(VULKAN_DIR vulkan/vulkan.h REQUIRED)  # headers; the loader itself is opened by volk at run time
find_program(GLSLANG glslangValidator REQUIRED)  # GLSL to SPIR-V at build time
find_program(SPIRV_VAL spirv-val REQUIRED)       # checks every module that is built
find_path(VOLK_DIR volk.c REQUIRED)              # loads Vulkan entry points, per device

# volk and Vulkan: prototypes are off everywhere, every call goes through volk's pointers.
add_library(third_party_volk STATIC volk.cpp)
target_include_directories(third_party_volk SYSTEM PUBLIC ${VOLK_DIR} ${VULKAN_DIR})
target_compile_definitions(third_party_volk PUBLIC VK_NO_PROTOTYPES)
target_link_libraries(third_party_volk PUBLIC ${CMAKE_DL_LIBS})
add_library(third_party::volk ALIAS third_party_volk)

if(NOT PALPATE_APPS)
  return()
endif()
find_package(CLI11 REQUIRED)          # the command line
find_package(glfw3 REQUIRED)          # the window
if(NOT WIN32)
  find_package(X11 REQUIRED)          # displays that a GPU cannot present to
  set_target_properties(X11::X11 PROPERTIES IMPORTED_GLOBAL TRUE)
endif()
find_path(IMGUI_DIR imgui.h PATH_SUFFIXES imgui REQUIRED)  # its panels: only the core, drawn by palpate's pass
find_library(IMGUI_LIBRARY imgui REQUIRED)
find_library(STB_LIBRARY stb)         # for the font of Debian's Dear ImGui
foreach(target glfw CLI11::CLI11)
  set_target_properties(${target} PROPERTIES IMPORTED_GLOBAL TRUE)
endforeach()

add_library(third_party_imgui INTERFACE)
target_include_directories(third_party_imgui SYSTEM INTERFACE ${IMGUI_DIR})
target_link_libraries(third_party_imgui INTERFACE ${IMGUI_LIBRARY})
if(STB_LIBRARY)
  target_link_libraries(third_party_imgui INTERFACE ${STB_LIBRARY})
endif()
add_library(third_party::imgui ALIAS third_party_imgui)
