#include "apps/view/stylus_hand.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptics/devices/guided_touch.hpp"

namespace palpate {

namespace {

constexpr double kDeepestPush_mm = 6, kFarthestPush_mm = 60;  // behind and in front of the surface
constexpr double kClose_px = 3;

}  // namespace

void StylusHand::hold(bool on) {
  held_ = on;
  hover_mm_ = kHover_mm;
  trigger_ = 0;
  planeDepth_ = 0;
  putDown_ = false;
}

void StylusHand::lift(double way_mm) { hover_mm_ = std::clamp(hover_mm_ + way_mm, -kDeepestPush_mm, kFarthestPush_mm); }

std::optional<double> StylusHand::depthAt(const DVec2& cursor_px, const Pick& picked, bool followsSurface,
                                          double beside) {
  // The visible surface, if the last pick was close to the cursor; else the stylus keeps its depth.
  const bool looked = glm::distance(picked.place_px, cursor_px) < kClose_px;
  const bool seen = looked && picked.depth > 0;
  // A hand that presses at one position does not go deeper because the surface yields.
  const bool rests = (trigger_ != 0 || hover_mm_ < 0) && glm::distance(picked.place_px, planePlace_px_) < kClose_px;
  if (seen && (planeDepth_ == 0 || (followsSurface && !rests))) {
    planeDepth_ = picked.depth;
    planePlace_px_ = picked.place_px;
  }
  // Without a visible surface the depth is a guess, and is not stored: the surface replaces it once it is visible.
  const double depth = planeDepth_ > 0 ? planeDepth_ : picked.depth;
  if (depth > 0) return depth;
  if (!looked) return std::nullopt;
  return beside;
}

double StylusHand::takeInward_mm(double press_mm) {
  if (!std::exchange(putDown_, true)) return -kHover_mm;
  if (trigger_ != 0) return -hover_mm_ + trigger_ * (hover_mm_ + press_mm);
  return -hover_mm_;
}

}  // namespace palpate
