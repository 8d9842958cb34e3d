#pragma once

#include "engine/edit/placed_brush.hpp"

namespace palpate {

/// The brush's tool in a stroke that begins with one tick, with the proxy `spring` from the HIP; `motion`: of the hand
/// since the stroke began. It acts on every part of the model.
inline BrushStroke::Tool toolAt(const BrushOptions& options, double support, const DVec3& hip, const DVec3& spring,
                                const DVec3& motion = DVec3(0)) {
  BrushStroke stroke(support);
  stroke.setBrush(options);
  const Contact contact{.touching = true};
  stroke.feel(contact, hip - motion, spring, Press::contact, 0);
  if (motion != DVec3(0)) stroke.feel(contact, hip, spring, Press::contact, 1e-3);
  BrushStroke::Tool tool = stroke.next(1e-3);
  tool.connected.fill(~0u);
  return tool;
}

/// A brush with that tool.
inline PlacedBrush brushAt(const BrushOptions& options, double support, const DVec3& hip, const DVec3& spring,
                           const DVec3& motion = DVec3(0)) {
  return {options, support, toolAt(options, support, hip, spring, motion)};
}

}  // namespace palpate
