// The back end of a cloud of which only the points around the hands are here.
#pragma once

#include <span>

#include "engine/core/vec.hpp"
#include "engine/touch/touch_backend.hpp"
#include "haptics/session/far_cloud.hpp"

namespace palpate {

/// Wraps the back end that feels the points that are here. Where a surface may depend on others, the hand feels
/// nothing.
class FarTouch : public TouchDecorator {
 public:
  using TouchDecorator::TouchDecorator;
  /// Before the first tick: waits up to `timeout_s` for the points around these hands. Returns whether they are known.
  virtual bool awaitAt(double time_s, std::span<const DVec3> hips, double timeout_s) = 0;
  /// For any thread.
  virtual UnknownTicks counts() const noexcept = 0;
};

}  // namespace palpate
