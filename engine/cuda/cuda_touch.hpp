#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "engine/touch/touch_backend.hpp"
#include "shaders/shared/hash_grid.h"

namespace palpate {

/// How a query finds the neighbours of the probe. The answers of all methods but `brute` are bitwise identical; `brute`
/// sums the same points in another order.
enum class CudaMethod {
  brute,       ///< one thread per point (thesis 4.3.1)
  twoStep,     ///< counts, the host reads the maximum, then rows of threads (thesis 4.3.2)
  naiveDp,     ///< one device thread launches a grid per bucket (thesis 4.3.3)
  arrayDp,     ///< the device lists the buckets and launches one grid for all of them (thesis 4.3.3)
  fused,       ///< one block does everything in one launch
  graph,       ///< the same launch as an instantiated graph
  persistent,  ///< the same block stays on the GPU and reads poses from host memory
};

/// The names of the methods on the command line, in the order of the enum.
std::span<const std::string_view> cudaMethodNames();
std::string_view nameOf(CudaMethod method);

struct CudaTouchOptions {
  double radius = 0;        ///< support radius, model units
  double friction = 0;      ///< friction coefficient of the proxy
  shared::HashGrid grid{};  ///< cells must be at least smallestCell() (engine/contact), which one gather covers
  CudaMethod method = CudaMethod::fused;
  std::optional<BrushOptions> push;  ///< edit while touching
  /// Measure each query on the GPU; in virtual time only, since measuring takes some us of the tick. The persistent
  /// method always measures itself.
  bool timeGpu = true;
};

/// The touch side on CUDA, as a baseline for Vulkan: the same data, the same answers, and the query methods of the
/// thesis with real dynamic parallelism. Supports one hand. Keeps no edit log; readBack() returns the edited points.
class CudaTouch final : public TouchBackend {
 public:
  /// `cloud` must have normals. Uploads it and builds the index. Throws CudaError.
  CudaTouch(const PointCloud& cloud, const CudaTouchOptions& options);
  ~CudaTouch() override;

  /// When the GPU is late, the tangent plane at the last proxy answers, and `fresh` is false: in full for 5 ms after it
  /// was found, then fading, and not at all after 20 ms.
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;

  /// The index is rebuilt for each edit.
  BackendReport report() const override;

 private:
  class State;
  std::unique_ptr<State> state_;
  Contact answer_;
};

}  // namespace palpate
