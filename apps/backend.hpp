// Which machine answers the poses, and by which method: the options that touch and bench share.
#pragma once

#include "apps/model.hpp"
#include "engine/touch/touch_side.hpp"

namespace palpate {

struct BackendOptions {
  std::string backend = "vulkan", method = "fused", surface = "average", index = "rebuild";
  std::string bucketKey = "teschner", sort = "auto", wait;
  bool deterministic = false, realtime = false;
  std::string radius = "auto";
  double cell_mm = 0, grid = 0;
  bool timePasses = false;
};
void addBackendOptions(CLI::App& command, BackendOptions& options);

/// A cloud ready to be touched. Keeps a reference to the model. Throws UsageError for what does not go together.
std::unique_ptr<TouchBackend> makeBackend(Context& context, const Model& model, const BackendOptions& options,
                                          const std::optional<PushOptions>& push);

}  // namespace palpate
