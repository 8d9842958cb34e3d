#include "haptics/devices/guided_touch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

// An aim that jumps from picture to picture becomes a motion: it is approached with this time constant.
constexpr double kGlide_s = 0.03;
constexpr double kSmallestStep_mm = 1e-3;  // resolution of the stylus: imperceptible

// A drawn stylus that has no contact for this time, or whose contact is farther than this behind, e.g. beyond a crease,
// is put down again; it may then need that time to reach contact.
constexpr double kLost_s = 0.06, kLost_mm = 3, kPutDown_s = 0.2;
constexpr double kBehind_s = 0.1;  // a stroke that is farther behind its pointer catches up

const DVec3 kNoStops_mm(1e6);  // a mouse has no stops

}  // namespace

SimulatedTouchOptions guidedHand(const DVec3& workspace_mm) {
  return {.handStiffness_N_per_mm = 0.6,
          .handDamping_N_s_per_mm = 0.006,
          .friction_N = 0,
          .encoderStep_mm = kSmallestStep_mm,
          .workspace_mm = workspace_mm};
}

GuidedTouch::GuidedTouch(const WorkspaceMap& map, const DVec3& parked, const GuidedOptions& options)
    : map_(map),
      options_(options),
      parked_(parked),
      glide_(parked),
      hand_(
          [this, unitsPer_mm = map.scale](double time_s) {
            const double dt_s = std::max(time_s - std::exchange(glideTime_s_, time_s), 0.0);
            const DVec3 way = (last_.lifted ? parked_ : last_.place) - glide_;
            const double length = glm::length(way), farthest = kFastestHand_mm_per_s * unitsPer_mm * dt_s;
            double share = 1 - std::exp(-dt_s / kGlide_s);
            if (share * length > farthest) share = farthest / length;
            glide_ += share * way;
            return glide_;
          },
          map, guidedHand(kNoStops_mm)) {
  aim_.place = last_.place = parked;
}

DeviceLimits GuidedTouch::limits() const {
  DeviceLimits limits = hand_.limits();
  limits.continuousForce_N = limits.peakForce_N;  // there are no motors that could get hot
  limits.buttons = 1;
  limits.countsTicks = options_.countsTicks;
  return limits;
}

bool GuidedTouch::aim(const DVec3& place, bool sculpts) noexcept {
  if (!isFinite(place) || (!aim_.lifted && place == aim_.place && sculpts == aim_.sculpts)) return false;
  aim_.putDowns += std::exchange(aim_.lifted, false);
  aim_.place = place;
  aim_.sculpts = sculpts;
  latest_.store(aim_);
  return true;
}

void GuidedTouch::lift() noexcept {
  aim_.lifted = true;
  aim_.sculpts = false;
  latest_.store(aim_);
}

void GuidedTouch::dropStroke() noexcept {
  strokes_.clear();
  wasDrawn_ = wasDrawn_ || pose_;
  pose_.reset();
}

// In front of the surface along the line of sight, which nothing visible crosses; below it against its normal.
DVec3 GuidedTouch::placeOf(const DrawnPose& pose) const noexcept {
  return pose.place - inward_ * (inward_ < 0 ? pose.toEye : pose.outward);
}

// Takes the poses of this tick, up to one at which the stylus is put down or let go; returns their number.
int GuidedTouch::takePoses() noexcept {
  const auto jumps = [](const DrawnPose& pose) { return pose.putDown || pose.ends; };
  const double behind_s = static_cast<double>(strokes_.pending()) * options_.tick_s;
  const int most = options_.catchesUp ? 1 + static_cast<int>(behind_s / kBehind_s) : 1;
  int taken = 0;
  for (const DrawnPose* next = strokes_.next(); next && taken < most; next = strokes_.next()) {
    if (taken > 0 && jumps(*next)) break;
    pose_ = *next;
    strokes_.drop();
    ++taken;
    if (jumps(*pose_)) break;
  }
  return taken;
}

// Never farther from the proxy than the stroke presses: a surface that yields is pressed no deeper, and a proxy that is
// held back is not left behind. What it holds goes along with the pointer alone: from the tick at which it takes hold
// it presses no deeper, and it comes down to there slowly, since an answer may be late.
void GuidedTouch::follow(const DrawnPose& pose, int ticks) noexcept {
  const double step = kFastestHand_mm_per_s * options_.tick_s * map_.scale * ticks;
  if (pose.holdsFrom && !grip_ && toProxy_ && map_.scale * glm::length(*toProxy_) > *pose.holdsFrom)
    grip_ = pose.inward - inward_;
  const double most = pose.holdsFrom && inward_ > 0 ? step / kGripTimes : step;
  inward_ += std::clamp(pose.inward - grip_.value_or(0) - inward_, -most, most);
  DVec3 to = placeOf(pose);
  if (toProxy_) {
    const DVec3 proxy = hip_ + map_.scale * *toProxy_, way = to - proxy;
    raised_ = std::max(raised_, glm::dot(proxy - pose.place, pose.outward));
    const double reach = std::max(pose.inward, 0.0), length = glm::length(way);
    if (length > reach) to = proxy + reach / length * way;
  }
  const double length = glm::distance(to, hip_);
  hip_ = length > step ? hip_ + step / length * (to - hip_) : to;
}

// Whether the stylus that presses has had no contact, or has stayed behind, for too long.
bool GuidedTouch::isLost(const DrawnPose& pose, int ticks) noexcept {
  if (pose.holdsFrom || !(inward_ > 0) || inward_ != pose.inward) return false;
  DVec3 behind = toProxy_ ? placeOf(pose) - hip_ - map_.scale * *toProxy_ : DVec3(0);
  // A surface that the stroke itself has raised is above its place, and not lost.
  behind += std::max(-glm::dot(behind, pose.outward) - pose.inward, 0.0) * pose.outward;
  const bool isNear = toProxy_ && glm::length(behind) - pose.inward <= kLost_mm * map_.scale;
  lost_s_ = isNear ? 0 : lost_s_ + ticks * options_.tick_s;
  return lost_s_ > kLost_s;
}

DeviceState GuidedTouch::readStroke() noexcept {
  const int ticks = takePoses();
  DeviceState state{.buttons = kSculptButton, .ok = true};
  if (ticks == 0) {
    state.waits = options_.countsTicks;
    pose_->putDown = false;
  }
  state.putDown = pose_->putDown || pose_->ends || isLost(*pose_, ticks);
  if (pose_->putDown) raised_ = 0;
  if (state.putDown) {
    grip_.reset();
    inward_ = -kHover_mm * map_.scale - raised_;
    hip_ = placeOf(*pose_);
    lost_s_ = -kPutDown_s;
  } else if (!state.waits) {
    follow(*pose_, std::max(ticks, 1));
  }
  state.position = (hip_ - map_.offset) / map_.scale;
  if (pose_->ends) {
    state.buttons = 0;
    wasDrawn_ = true;
    pose_.reset();
  }
  return state;
}

DeviceState GuidedTouch::read(double time_s) noexcept {
  if (givesUp_.exchange(false)) dropStroke();
  if (pose_ || strokes_.next()) return readStroke();
  const Aim aim = latest_.load().value_or(last_);
  const bool moved = std::exchange(wasDrawn_, false) || aim.putDowns != last_.putDowns || aim.lifted != last_.lifted;
  last_ = aim;
  if (moved) {
    glide_ = aim.lifted ? parked_ : aim.place;
    glideTime_s_ = time_s;
    hand_.putDown(time_s);
  }
  DeviceState state = hand_.read(time_s);
  state.putDown = moved;
  state.buttons = aim.sculpts ? kSculptButton : 0;
  const bool isStill = std::exchange(lastPosition_, state.position) == state.position;
  state.rests = isStill && !moved && !aim.sculpts && !toProxy_;
  return state;
}

}  // namespace palpate
