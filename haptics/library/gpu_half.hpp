// The parts of the library that need a GPU. A build without Vulkan has the same class, which refuses its calls.
#pragma once

#include <palpate/palpate.h>

#include <memory>
#include <string>
#include <vector>

#include "engine/core/edit_batch.hpp"
#include "engine/edit/history.hpp"
#include "engine/mesh/mesh.hpp"
#include "engine/mesh/mesh_plan.hpp"
#include "engine/render/image.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/picture_request.hpp"
#include "haptics/session/scene.hpp"

namespace palpate::library {

/// Names of the GPUs of this machine, in the order of their numbers; empty without Vulkan.
std::vector<std::string> gpuNames();
/// True if there is a GPU that palpate can use and that is not a software driver.
bool hasRealGpu();
/// GPU that the program requests (pp_session_options).
struct GpuChoice {
  const char* gpu = nullptr;               ///< number or part of a name; "cpu": none; null: one if available
  const pp_vulkan_device* lent = nullptr;  ///< instead of one by name
};
/// Name of the back end that answers. `backend`: auto, vulkan or cpu; null: auto. `automaticIsGpu`: called for
/// auto without a named or lent GPU. Throws UsageError for another word, or if it conflicts with the GPU.
std::string backendOf(const char* backend, const GpuChoice& choice, bool (*automaticIsGpu)());
/// Throws UnsupportedError without Vulkan, FileError.
void writePicture(const std::string& file, const Image& image);

/// The GPU of one session, opened at its first use: the back end, pictures and meshes. For one thread at a time, except
/// that the back end submits queries on its own queue.
class GpuHalf {
 public:
  /// Opens a lent device at once. Throws GpuError, and UsageError if a GPU is named as well.
  explicit GpuHalf(const GpuChoice& choice);
  ~GpuHalf();
  GpuHalf(const GpuHalf&) = delete;
  GpuHalf& operator=(const GpuHalf&) = delete;

  /// Back end on this GPU; this must outlive it and all that it makes. Throws UnsupportedError without Vulkan.
  std::unique_ptr<BackendKind> backend();
  /// Updates the drawn points. Never fails: after an error the next picture copies all points again.
  void follow(const EditBatch& batch) noexcept;
  /// Discards the drawn points, because others replace them.
  void forgetPicture();
  /// SessionPicture::draw().
  Image draw(const Layer& layer, const History* history, const PictureRequest& request);
  /// Meshes by marching cubes. Throws OutOfGpuMemory.
  Mesh mesh(const PointCloud& cloud, const MeshPlan& plan);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate::library
