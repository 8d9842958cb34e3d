#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "engine/core/touch_backend.hpp"
#include "shaders/shared/hash_grid.h"

namespace palpate {

/// How a query finds the neighbours of the probe. All but `brute` agree bit by bit on what they answer; `brute` adds up
/// the same points in another order.
enum class CudaMethod {
  brute,       ///< a thread for every point (thesis 4.3.1)
  twoStep,     ///< counts, the host reads the largest, then rows of threads (thesis 4.3.2)
  naiveDp,     ///< one device thread launches a grid for every bucket (thesis 4.3.3)
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
  double friction = 0;      ///< coefficient of a proxy that slides
  shared::HashGrid grid{};  ///< cells not smaller than one gather covers (smallestCell() of engine/contact)
  CudaMethod method = CudaMethod::fused;
  std::optional<BrushOptions> push;  ///< edit while touching
  /// Measure each query on the GPU. Done in virtual time only, since the measuring itself takes some us of the tick;
  /// the persistent method measures itself and always says.
  bool timeGpu = true;
};

/// The touch side on CUDA: the comparison that Vulkan is held against. The same data, the same answers, and the query
/// methods of the thesis with real dynamic parallelism. It answers one hand. It keeps no edit log; readBack() gives the
/// edited points.
class CudaTouch final : public TouchBackend {
 public:
  /// `cloud` must have normals. Uploads it and builds the index. Throws CudaError.
  CudaTouch(const PointCloud& cloud, const CudaTouchOptions& options);
  ~CudaTouch() override;

  /// When the GPU is late, the tangent plane at the last proxy answers, and `fresh` says so: in full for 5 ms after it
  /// was found, then ever softer, and past 20 ms not at all.
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override;

  std::string machine() const override;
  double buildTime_us() const override;
  const std::vector<double>& editTimes_us() const override;
  /// Builds it anew for each edit.
  IndexWork indexWork() const override { return {.built = editTimes_us().size()}; }
  std::optional<double> firstEditTime_s() const override;
  const TouchShortfalls& shortfalls() const override;
  double cell() const override;

 private:
  class State;
  std::unique_ptr<State> state_;
  Contact answer_;
};

}  // namespace palpate
