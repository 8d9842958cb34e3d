#pragma once

#include "engine/contact/contact_step.hpp"

namespace palpate {

struct PushOptions {
  double tau = 0;         ///< how deep the HIP may stand behind the proxy before the surface yields, model units
  double beta = 0;        ///< share of the way to its target that a point goes in one tick, 0 to 1
  double toolRadius = 0;  ///< of the round tool, model units
};

/// Pushes the points around the proxy with a round tool (thesis section 5.2). Moved points are marked in the live cloud
/// until RefitNormals has seen them.
class PushBrush {
 public:
  PushBrush(Device& device, const PushOptions& options);

  /// Reads the contact state of this tick. No point moves further than `longestMove` (model units) in a tick, so that
  /// the proxy keeps its surface.
  void record(CommandList& list, const LiveCloud::Side& side, std::uint32_t count, const Buffer& contactState,
              double longestMove) const;
  const PushOptions& options() const { return options_; }

 private:
  PushOptions options_;
  ComputePipeline push_;
};

}  // namespace palpate
