#include "haptics/session/pointer_stroke.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptics/devices/guided_touch.hpp"

namespace palpate {

namespace {

constexpr double kStep_px = 2;         // along the path
constexpr double kMaxSpread_s = 0.02;  // the way between two events is made within this time
constexpr double kPress_s = 0.02;      // at its depth before it follows the path: a tap leaves a trace
constexpr double kStep_mm = 2;         // of the depth that the slope need not explain

}  // namespace

PointerStroke::PointerStroke(FoundSurface found, const StrokeOptions& options, const DVec2& place_px, double time_s)
    : found_(std::move(found)),
      options_(options),
      begin_s_(time_s),
      event_s_(time_s),
      path_{{.place_px = place_px, .inward = options.inward, .time_s = time_s}},
      last_(path_.back()),
      inward_(options.inward) {}

// The way to an event begins with it, and takes as long as the time since the event before.
void PointerStroke::moveTo(const DVec2& pointer_px, double time_s) {
  const Place from = last_;
  DVec2 place_px = pointer_px;
  if (options_.string_px > 0) {
    const DVec2 pull_px = pointer_px - from.place_px;
    const double length = glm::length(pull_px);
    place_px = from.place_px + (length > options_.string_px ? 1 - options_.string_px / length : 0.0) * pull_px;
  }
  time_s = std::max(time_s, event_s_);
  const double spread_s = std::min(time_s - std::exchange(event_s_, time_s), kMaxSpread_s);
  const double count = std::ceil(glm::distance(from.place_px, place_px) / kStep_px);
  for (double i = 1; i <= count; ++i) {
    last_.place_px = from.place_px + i / count * (place_px - from.place_px);
    last_.time_s = std::max(from.time_s, time_s + (i - 1) / count * spread_s);
    path_.push_back(last_);
  }
}

void PointerStroke::deepen(double way, double time_s) {
  last_.inward += way;
  last_.time_s = std::max(last_.time_s, event_s_ = std::max(time_s, event_s_));
  path_.push_back(last_);
}

void PointerStroke::release(double time_s) {
  if (!release_s_) release_s_ = std::max(time_s, event_s_);
}

double PointerStroke::step() const { return options_.unitsPer_mm * kFastestHand_mm_per_s * options_.tick_s; }

std::optional<FoundSpot> PointerStroke::spotAt(const DVec2& place_px) const {
  if (!first_ || !(options_.holdsFrom || options_.inPlane)) return found_.at(place_px);
  FoundSpot spot = *first_;
  spot.place = found_.inPlane(*first_, place_px);
  return spot;
}

void PointerStroke::putDown(const FoundSpot& spot) {
  const double pressing = std::max(inward_, 0.0) * (options_.holdsFrom ? kGripTimes : 1);
  const double descent = kHover_mm * options_.unitsPer_mm + pressing;
  rest_ = static_cast<std::uint64_t>(std::ceil(descent / step()));
  if (!first_) {
    first_ = spot;
    if (options_.inPlane && !options_.holdsFrom) first_->outward = spot.toEye;
    rest_ += static_cast<std::uint64_t>(std::ceil(kPress_s / options_.tick_s));
  }
  spot_ = first_->place == spot.place ? first_ : spot;
  isLifted_ = false;
}

DrawnPose PointerStroke::pose() const {
  const double hover = kHover_mm * options_.unitsPer_mm;
  return {.place = options_.origin + spot_->place,
          .outward = spot_->outward,
          .toEye = spot_->toEye,
          .inward = isLifted_ ? -hover : inward_,
          .holdsFrom = options_.holdsFrom};
}

// Follows the path, no faster than a hand moves, as far as it was drawn by now. Returns whether the stylus is put down
// or lifted.
bool PointerStroke::advance() {
  double left = step();
  for (; !path_.empty() && path_.front().time_s <= now_s(); path_.pop_front()) {
    inward_ = path_.front().inward;
    const auto to = spotAt(path_.front().place_px);
    if (!to && isLifted_) continue;
    if (!to || isLifted_ || found_.isStep(*spot_, *to, kStep_px, kStep_mm * options_.unitsPer_mm)) {
      path_.pop_front();
      isLifted_ = true;
      if (to) putDown(*to);
      return true;
    }
    const double length = glm::distance(spot_->place, to->place);
    if (length > left) {
      const double share = left / length;
      spot_->place += share * (to->place - spot_->place);
      spot_->outward = glm::normalize(glm::mix(spot_->outward, to->outward, share));
      spot_->toEye = glm::normalize(glm::mix(spot_->toEye, to->toEye, share));
      spot_->depth += share * (to->depth - spot_->depth);
      return false;
    }
    left -= length;
    spot_ = to;
  }
  return false;
}

std::optional<DrawnPose> PointerStroke::next() {
  bool jumps = false;
  if (rest_ > 0)
    --rest_;
  else
    jumps = advance();
  over_ = release_s_ && rest_ == 0 && path_.empty() && now_s() >= *release_s_;
  ++tick_;
  if (!spot_) return std::nullopt;
  DrawnPose next = pose();
  next.putDown = jumps;
  next.ends = over_;
  return next;
}

}  // namespace palpate
