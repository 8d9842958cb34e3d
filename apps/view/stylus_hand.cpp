#include "apps/view/stylus_hand.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

namespace {

constexpr double kDepthPerNotch_mm = 0.5;
constexpr double kHover_mm = 4;                               // before the surface
constexpr double kDeepestPush_mm = 6, kFarthestPush_mm = 60;  // behind and before the surface
constexpr double kClose_px = 3;

}  // namespace

void StylusHand::hold(bool on) {
  held_ = on;
  pressing_ = false;
  hover_mm_ = kHover_mm;
  extraPress_mm_ = trigger_ = 0;
  planeDepth_ = 0;
  putDown_ = false;
}

void StylusHand::press() {
  pressing_ = true;
  extraPress_mm_ = 0;
}

void StylusHand::turnWheel(double notches) {
  double& depth_mm = pressing_ ? extraPress_mm_ : hover_mm_;
  depth_mm += (pressing_ ? 1 : -1) * kDepthPerNotch_mm * notches;
}

void StylusHand::lift(double way_mm) { hover_mm_ = std::clamp(hover_mm_ + way_mm, -kDeepestPush_mm, kFarthestPush_mm); }

std::optional<double> StylusHand::depthAt(const DVec2& cursor_px, const Pick& picked, bool followsSurface,
                                          double beside) {
  // The surface that is seen, where the last picture was looked at close to here; else the stylus keeps its depth.
  const bool looked = glm::distance(picked.place_px, cursor_px) < kClose_px;
  const bool seen = looked && picked.depth > 0;
  // A hand that presses in one place goes no deeper because the surface gives way.
  const bool rests =
      (pressing_ || trigger_ != 0 || hover_mm_ < 0) && glm::distance(picked.place_px, planePlace_px_) < kClose_px;
  if (seen && (planeDepth_ == 0 || (followsSurface && !rests))) {
    planeDepth_ = picked.depth;
    planePlace_px_ = picked.place_px;
  }
  // Until then a guess, which must not hold the stylus back from the surface once that is seen.
  const double depth = planeDepth_ > 0 ? planeDepth_ : picked.depth;
  if (depth > 0) return depth;
  if (!looked) return std::nullopt;
  return beside;
}

double StylusHand::takeInward_mm(double press_mm) {
  if (!std::exchange(putDown_, true)) return -kHover_mm;
  if (trigger_ != 0) return -hover_mm_ + trigger_ * (hover_mm_ + press_mm);
  return pressing_ ? press_mm + extraPress_mm_ : -hover_mm_;
}

}  // namespace palpate
