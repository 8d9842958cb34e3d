#pragma once

#include "engine/contact/contact_step.hpp"
#include "engine/core/touch_backend.hpp"

namespace palpate {

/// Pushes the points around the proxy with a round tool (thesis section 5.2). Moved points are marked in the live cloud
/// until RefitNormals has seen them.
class PushBrush {
 public:
  PushBrush(Device& device, const BrushOptions& options);

  /// Reads the contact state of this tick. No point moves further than `longestMove` (model units) in a tick, so that
  /// the proxy keeps its surface.
  void record(CommandList& list, const LiveCloud::Side& side, std::uint32_t count, const Buffer& contactState,
              double longestMove) const;
  const BrushOptions& options() const { return options_; }

 private:
  BrushOptions options_;
  ComputePipeline push_;
};

}  // namespace palpate
