// Lets a test lose the GPU: see layer.cpp. The layer is in the folder lost_gpu beside the test program, or in
// PALPATE_LOST_GPU_FOLDER.
#pragma once

#include <dlfcn.h>
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/asked_validation.hpp"

namespace palpate {

/// The minimum GPU that palpate accepts: wider workgroups than Vulkan guarantees, and scalar block layout.
inline const std::string kMinGpu =
    "minimum:maxComputeWorkGroupInvocations=256,maxComputeWorkGroupSize=256,scalarBlockLayout=1";

/// During its lifetime, new Vulkan instances of this process, and of programs that it starts, use the layer. Fails the
/// test if the layer is missing.
class LostGpuLayer {
 public:
  /// `when`: "submit:N" or "fence:N", after N submissions of the next device; "count": never, but a program reports its
  /// number of submissions at its end; "display": never, but a query about a surface ends the program;
  /// "coarse": never, but the period of timestamps is 1000 ns;
  /// "minimum:NAME=VALUE,...": never, but the GPU is the minimum of Vulkan (made_up_gpu.hpp); empty: by takeGpu().
  explicit LostGpuLayer(const std::string& when = {}) {
    for (const char* file : {kLibrary, "layer.json"})
      REQUIRE_MESSAGE(std::filesystem::exists(folder() / file),
                      "no " << (folder() / file).string()
                            << "; build the target palpate_lost_gpu, or set PALPATE_LOST_GPU_FOLDER to its folder");
    const char* others = std::getenv("VK_LAYER_PATH");
    if (others) layersBefore_ = others;
    // Validation, if requested, is above this layer and sees the changed properties: layers are stacked in the order in
    // which the loader finds them.
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

  /// The function that loses the GPU, once a device exists: its next submission fails (`atSubmit`), or hangs until its
  /// fence reports the loss. Fails the test if the layer is not in use; the returned function never does and may be
  /// called anywhere.
  using TakeGpu = void (*)(bool atSubmit);
  static TakeGpu takeGpu() {
    const std::filesystem::path library = folder() / kLibrary;
    void* layer = ::dlopen(library.c_str(), RTLD_NOW | RTLD_NOLOAD);
    REQUIRE_MESSAGE(layer, "the Vulkan loader has not loaded " << library.string());
    const auto take = reinterpret_cast<TakeGpu>(::dlsym(layer, "palpateLoseGpu"));
    ::dlclose(layer);  // the loader keeps it loaded
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
