// Lets a test take the GPU away: see layer.cpp.
#pragma once

#include <dlfcn.h>
#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

namespace palpate {

/// While it lives, new Vulkan instances of this process, and of programs that it starts, go through the layer.
class LostGpuLayer {
 public:
  /// `when`: "submit:N" or "fence:N", after N submissions of the next device; empty: when loseGpu() says.
  explicit LostGpuLayer(const std::string& when = {}) {
    ::setenv("VK_LAYER_PATH", PALPATE_LOST_GPU_FOLDER, 1);
    ::setenv("VK_INSTANCE_LAYERS", "VK_LAYER_PALPATE_lost_gpu", 1);
    if (!when.empty()) ::setenv("PALPATE_LOST_GPU", when.c_str(), 1);
  }
  ~LostGpuLayer() {
    for (const char* name : {"VK_LAYER_PATH", "VK_INSTANCE_LAYERS", "PALPATE_LOST_GPU"}) ::unsetenv(name);
  }
  LostGpuLayer(const LostGpuLayer&) = delete;
  LostGpuLayer& operator=(const LostGpuLayer&) = delete;

  /// Once a device has been made: its next submission fails (`atSubmit`), or hangs until its fence tells.
  static void loseGpu(bool atSubmit) {
    void* layer = ::dlopen(PALPATE_LOST_GPU_FOLDER "/libpalpate_lost_gpu.so", RTLD_NOW | RTLD_NOLOAD);
    REQUIRE_MESSAGE(layer, "the layer is not in use");
    const auto lose = reinterpret_cast<void (*)(bool)>(::dlsym(layer, "palpateLoseGpu"));
    REQUIRE(bool(lose != nullptr));
    lose(atSubmit);
    ::dlclose(layer);
  }
};

}  // namespace palpate
