#include "apps/view/stylus_hand.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {

namespace {

constexpr double kDepthPerNotch_mm = 0.5;
constexpr double kHover_mm = 4;                               // in front of the surface
constexpr double kDeepestPush_mm = 6, kFarthestPush_mm = 60;  // behind and in front of the surface
constexpr double kClose_px = 3;

}  // namespace

DVec3 normalAt(const Pick& pick, const Camera& camera, const DVec2& size_px) {
  const DVec3 place = camera.unproject(pick.place_px, pick.depth, size_px);
  const DVec3 toEye = glm::normalize(camera.eye - place);
  // Of the two positions beside it, the one nearer in depth is on the same surface.
  const auto along = [&](std::size_t first, const DVec2& way_px) -> std::optional<DVec3> {
    std::optional<DVec3> best;
    double least = 0;
    for (const std::size_t k : {first, first + 1}) {
      if (!(pick.beside[k] > 0)) continue;
      const double side = k == first ? -1 : 1, gap = std::abs(pick.beside[k] - pick.depth);
      if (best && gap >= least) continue;
      least = gap;
      best = side * (camera.unproject(pick.place_px + side * way_px, pick.beside[k], size_px) - place);
    }
    return best;
  };
  if (!(pick.depth > 0)) return toEye;
  const auto right = along(0, {pick.beside_px, 0}), down = along(2, {0, pick.beside_px});
  if (!right || !down) return toEye;
  const DVec3 normal = glm::cross(*down, *right);
  const double length = glm::length(normal);
  if (!(length > 0)) return toEye;
  // A normal seen at a grazing angle is unreliable.
  constexpr double kMinTowardsEye = 0.3;
  const DVec3 facing = (glm::dot(normal, toEye) < 0 ? -1.0 : 1.0) / length * normal;
  return glm::dot(facing, toEye) < kMinTowardsEye ? toEye : facing;
}

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
  // The visible surface, if the last pick was close to the cursor; else the stylus keeps its depth. A pressing stylus
  // uses the last pick however far the cursor has moved since.
  const bool looked = pressing_ || glm::distance(picked.place_px, cursor_px) < kClose_px;
  const bool seen = looked && picked.depth > 0;
  isBeside_ = pressing_ && looked && !seen;
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
  return pressing_ && !isBeside_ ? press_mm + extraPress_mm_ : -hover_mm_;
}

}  // namespace palpate
