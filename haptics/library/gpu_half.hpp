// What of the library needs a GPU. A library that is built without Vulkan has the same class, which says so.
#pragma once

#include <palpate/palpate.h>

#include <memory>
#include <string>
#include <vector>

#include "engine/core/edit_batch.hpp"
#include "engine/edit/journal.hpp"
#include "engine/mesh/mesh.hpp"
#include "engine/mesh/mesh_plan.hpp"
#include "engine/render/image.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/picture_request.hpp"

namespace palpate::library {

/// The GPUs of this machine by name, in the order of their numbers; none where there is no Vulkan.
std::vector<std::string> gpuNames();
/// Whether there is a GPU that palpate can use and that is no software driver.
bool hasRealGpu();
/// Which GPU a program wants (pp_session_options), if any.
struct GpuChoice {
  const char* gpu = nullptr;               ///< number or part of a name; "cpu": none; null: one where there is one
  const pp_vulkan_device* lent = nullptr;  ///< in place of one by name

  /// The back end that answers.
  std::string backend() const {
    const std::string name = gpu ? gpu : "";
    return name == "cpu" || (name.empty() && !lent && !hasRealGpu()) ? "cpu" : "vulkan";
  }
};
/// Throws UnsupportedError without Vulkan, FileError.
void writePicture(const std::string& file, const Image& image);

/// The GPU of one session, opened at its first use: what answers on it, pictures and meshes. Used by one thread at a
/// time, but that the back end asks on its own queue.
class GpuHalf {
 public:
  /// One that is lent is taken up at once. Throws GpuError, and UsageError where one is named besides.
  explicit GpuHalf(const GpuChoice& choice);
  ~GpuHalf();
  GpuHalf(const GpuHalf&) = delete;
  GpuHalf& operator=(const GpuHalf&) = delete;

  /// What answers there; this outlives it, and all that it makes. Throws UnsupportedError without Vulkan.
  std::unique_ptr<BackendKind> backend();
  /// The picture follows what was done. Never fails: the next picture says what went wrong.
  void follow(const EditBatch& batch) noexcept;
  /// Forgets the points that were drawn: others come in their place.
  void forgetPicture();
  /// SessionPicture::draw().
  Image draw(const Model& model, const Journal* journal, const PictureRequest& request);
  /// By marching cubes. Throws OutOfGpuMemory.
  Mesh mesh(const PointCloud& cloud, const MeshPlan& plan);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate::library
