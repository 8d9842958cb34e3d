// Lets a test take the GPU away: see layer.cpp. The layer lies in a folder lost_gpu beside the test program, or where
// PALPATE_LOST_GPU_FOLDER says.
#pragma once

#include <dlfcn.h>
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/asked_validation.hpp"

namespace palpate {

/// The least GPU that palpate takes: wider workgroups than Vulkan promises, and the layout of C++.
inline const std::string kMinGpu =
    "minimum:maxComputeWorkGroupInvocations=256,maxComputeWorkGroupSize=256,scalarBlockLayout=1";

/// While it lives, new Vulkan instances of this process, and of programs that it starts, go through the layer. Ends the
/// test where it does not find it.
class LostGpuLayer {
 public:
  /// `when`: "submit:N" or "fence:N", after N submissions of the next device; "count": never, but a program that ends
  /// says how many it made; "display": never, but a question about a surface ends the program;
  /// "minimum:NAME=VALUE,...": never, but the GPU is the least that Vulkan lets one be (made_up_gpu.hpp); empty: when
  /// takeGpu() is called.
  explicit LostGpuLayer(const std::string& when = {}) {
    for (const char* file : {kLibrary, "layer.json"})
      REQUIRE_MESSAGE(std::filesystem::exists(folder() / file),
                      "no " << (folder() / file).string()
                            << "; build palpate_lost_gpu, or let PALPATE_LOST_GPU_FOLDER say where it is");
    const char* others = std::getenv("VK_LAYER_PATH");
    if (others) layersBefore_ = others;
    // Validation stands above this layer, where it is asked for, and sees what this one makes of the driver: layers are
    // stacked in the order in which the loader finds them.
    ::setenv("VK_LAYER_PATH", (layersBefore_.value_or(kDebianLayers) + ":" + folder().string()).c_str(), 1);
    const bool seen = when.starts_with("minimum") && askedValidation() != Validation::off;
    ::setenv("VK_INSTANCE_LAYERS",
             seen ? "VK_LAYER_KHRONOS_validation:VK_LAYER_PALPATE_lost_gpu" : "VK_LAYER_PALPATE_lost_gpu", 1);
    if (!when.empty()) ::setenv("PALPATE_LOST_GPU", when.c_str(), 1);
  }
  ~LostGpuLayer() {
    for (const char* name : {"VK_LAYER_PATH", "VK_INSTANCE_LAYERS", "PALPATE_LOST_GPU"}) ::unsetenv(name);
    if (layersBefore_) ::setenv("VK_LAYER_PATH", layersBefore_->c_str(), 1);
  }
  LostGpuLayer(const LostGpuLayer&) = delete;
  LostGpuLayer& operator=(const LostGpuLayer&) = delete;

  /// What takes the GPU away, once a device has been made: its next submission fails (`atSubmit`), or hangs until its
  /// fence tells. Ends the test where the layer is not in use; what it returns never does, and may be called anywhere.
  using TakeGpu = void (*)(bool atSubmit);
  static TakeGpu takeGpu() {
    const std::filesystem::path library = folder() / kLibrary;
    void* layer = ::dlopen(library.c_str(), RTLD_NOW | RTLD_NOLOAD);
    REQUIRE_MESSAGE(layer, "the Vulkan loader has not taken in " << library.string());
    const auto take = reinterpret_cast<TakeGpu>(::dlsym(layer, "palpateLoseGpu"));
    ::dlclose(layer);  // the loader holds it
    REQUIRE_MESSAGE(bool(take != nullptr), "no palpateLoseGpu in " << library.string());
    return take;
  }

 private:
  static constexpr const char* kDebianLayers = "/usr/share/vulkan/explicit_layer.d";
  static constexpr const char* kLibrary = "libpalpate_lost_gpu.so";
  static std::filesystem::path folder() {
    if (const char* elsewhere = std::getenv("PALPATE_LOST_GPU_FOLDER")) return elsewhere;
    return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "lost_gpu";
  }

  std::optional<std::string> layersBefore_;
};

}  // namespace palpate
