#include "engine/motion/depth_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include "engine/core/clock.hpp"
#include "engine/core/parallel.hpp"
#include "shaders/shared/motion.h"

namespace palpate {

namespace {

constexpr double kFastest_m_s = 1;   // maximum speed of a followed surface towards the camera or away from it
constexpr double kMinWay = 0.01;     // in depths: displacement allowed for noise
constexpr double kMinFacing = 0.2;   // minimum dot product of the normals before and after
constexpr double kSameDepth = 0.02;  // in depths: maximum difference of adjacent pixels on one surface

struct Seen {
  DVec3 place;  // world coordinates
  std::size_t pixel = 0;
};

/// A depth frame that is sampled at positions of another frame.
class SeenFrame {
 public:
  SeenFrame(const DepthCamera& camera, const DepthFrame& frame)
      : camera_(camera), depths_(frame.depth_m), axes_(frame.pose.value_or(CameraPose{})) {}

  /// Position on the surface seen `between_s` earlier along the ray through `place`; nothing if no surface or another
  /// one was seen.
  std::optional<Seen> before(const DVec3& place, std::size_t /*pixel*/, double between_s) const {
    const DVec3 inCamera = axes_.toCamera(place);
    if (!(inCamera.z > 0)) return std::nullopt;
    const std::optional<DVec2> at = placeWithin(camera_.pixelOf(inCamera));
    if (!at) return std::nullopt;
    const double depth = depthAt(*at);
    const double most = std::max(kMinWay * inCamera.z, kFastest_m_s * between_s);
    if (!(depth > 0) || !(std::abs(depth - inCamera.z) <= most)) return std::nullopt;
    return Seen{.place = axes_.toWorld(camera_.placeAt(at->x, at->y, depth)),
                .pixel = pixelAt(at->x + 0.5, at->y + 0.5)};
  }

 private:
  /// Position in the image, clamped to the centres of the outermost pixels; nothing outside the image.
  std::optional<DVec2> placeWithin(const DVec2& place) const {
    const DVec2 last(camera_.width - 1, camera_.height - 1);
    if (!(place.x > -0.5 && place.y > -0.5 && place.x < last.x + 0.5 && place.y < last.y + 0.5)) return std::nullopt;
    return glm::clamp(place, DVec2(0), last);
  }
  /// Truncates, which is faster than rounding.
  std::size_t pixelAt(double column, double row) const {
    return static_cast<std::size_t>(row) * camera_.width + static_cast<std::size_t>(column);
  }
  /// Depth on the ray through a position in the image: interpolated if the four pixels see one surface, else that of
  /// the nearest pixel. 0: no depth.
  double depthAt(const DVec2& place) const {
    const double left = std::min(static_cast<double>(static_cast<std::uint32_t>(place.x)), camera_.width - 2.0);
    const double top = std::min(static_cast<double>(static_cast<std::uint32_t>(place.y)), camera_.height - 2.0);
    const std::size_t corner = pixelAt(left, top), below = corner + camera_.width;
    const std::array<double, 4> d{depths_[corner], depths_[corner + 1], depths_[below], depths_[below + 1]};
    const double x = place.x - left, y = place.y - top;
    const double nearest = std::min(std::min(d[0], d[1]), std::min(d[2], d[3]));
    const double farthest = std::max(std::max(d[0], d[1]), std::max(d[2], d[3]));
    if (!(nearest > 0) || !(farthest - nearest <= kSameDepth * nearest)) {
      const double depth = d[(y < 0.5 ? 0 : 2) + (x < 0.5 ? 0 : 1)];
      return depth > 0 && std::isfinite(depth) ? depth : 0;
    }
    // The inverse of depth is linear in the image of a plane: 1 / ((1 - y) ((1 - x) / d0 + x / d1) + ...), written with
    // one division, since divisions dominate the cost.
    const double upper = d[0] * d[1], lower = d[2] * d[3];
    return upper * lower / ((1 - y) * ((1 - x) * d[1] + x * d[0]) * lower + y * ((1 - x) * d[3] + x * d[2]) * upper);
  }

  const DepthCamera& camera_;
  const std::vector<float>& depths_;
  CameraAxes axes_;
};

/// Points that a sensor measured on its rays, in its own axes.
class SeenPoints {
 public:
  SeenPoints(std::size_t rays, const DepthFrame& frame)
      : points_(*frame.points), axes_(frame.pose.value_or(CameraPose{})), at_(rays, kNone) {
    for (std::size_t i = 0; i < points_.rays.size(); ++i) at_[points_.rays[i]] = static_cast<std::uint32_t>(i);
  }

  std::optional<Seen> before(const DVec3& place, std::size_t ray, double between_s) const {
    if (at_[ray] == kNone) return std::nullopt;
    const DVec3& there = points_.places[at_[ray]];
    const double most = std::max(kMinWay * glm::length(there), kFastest_m_s * between_s);
    const DVec3 seen = axes_.toWorld(there);
    if (!(glm::distance(place, seen) <= most)) return std::nullopt;
    return Seen{.place = seen, .pixel = ray};
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  const SensedPoints& points_;
  CameraAxes axes_;
  std::vector<std::uint32_t> at_;  // point index by ray
};

/// Change of a normal from its current value (`before` less its remaining change `late`) to `normal`; zero if the
/// current value is zero or faces away.
DVec3 turnTo(const DVec3& normal, const DVec3& before, const DVec3& late) {
  const DVec3 from = shared::normalAfter(before, late, -1.0);
  return glm::dot(from, normal) > kMinFacing ? normal - from : DVec3(0);
}

// Frames further apart are not blended: the motion in between is unknown.
constexpr double kLongestGap_s = 0.2;
// From points on the host to points that can be felt: enough to copy and index 300,000 of them.
constexpr double kHandOver_s = 0.003;
// Without a new frame for this time, points that have arrived are made once more, so that they are drawn and saved at
// rest.
constexpr double kSettled_s = 0.1;

// Frames are made beside a servo thread that may lack real-time priority: most cores stay free.
unsigned frameThreads() { return std::clamp(std::thread::hardware_concurrency() / 4, 1u, 4u); }

}  // namespace

bool DepthBlend::canFollow(const DepthFrame& before, const DepthFrame& frame) {
  if (!before.points || !frame.points) return !before.points && !frame.points;
  return !before.points->rays.empty() && !frame.points->rays.empty() &&
         before.points->rowLength == frame.points->rowLength;
}

void DepthBlend::begin(CloudFrame& points) {
  points.velocities.clear();
  points.turns.clear();
  points.extrapolationLimit_s = kMaxPointsAge_s;
  ways_.clear();
}

void DepthBlend::follow(const DepthCamera& camera, const Before& before, const DepthFrame& frame, const DVec3& origin,
                        const std::vector<std::uint32_t>& pixels, const Step& step, CloudFrame& points) {
  const double share = ways_.empty() ? 0 : std::clamp(1 - step.since_s / waysLast_s_, 0.0, 1.0);  // still to come
  const std::size_t rays = std::size_t{camera.width} * camera.height;
  left_.swap(ways_);
  ways_.assign(rays, {});
  waysLast_s_ = step.lasts_s;
  points.velocities.assign(points.size(), Vec3(0));
  points.turns.assign(points.size(), Vec3(0));
  const double toGo = 1 - std::clamp(step.gone_s / step.lasts_s, 0.0, 1.0);
  points.extrapolationLimit_s = toGo * step.lasts_s;
  points.slides = false;
  const auto followIn = [&](const auto& seenBefore) {
    parallelFor(points.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const DVec3 place = DVec3(points.positions[i]) + origin, normal(points.normals[i]);
        const auto seen = seenBefore.before(place, pixels[i], step.between_s);
        if (!seen) continue;
        const Way late = share > 0 ? left_[seen->pixel] : Way{};
        const DVec3 way = place - seen->place + share * DVec3(late.way);
        const DVec3 turn = turnTo(normal, DVec3(before.normals[seen->pixel]), share * DVec3(late.turn));
        ways_[pixels[i]] = {.way = Vec3(way), .turn = Vec3(turn)};
        points.positions[i] = Vec3(place - toGo * way - origin);
        points.normals[i] = Vec3(shared::normalAfter(normal, turn, -toGo));
        points.velocities[i] = Vec3(way / step.lasts_s);
        points.turns[i] = Vec3(turn / step.lasts_s);
      }
    });
  };
  if (frame.points)
    followIn(SeenPoints(rays, before.frame));
  else
    followIn(SeenFrame(camera, before.frame));
}

DepthSource::DepthSource(std::shared_ptr<PlayedStream> stream, const DVec3& origin)
    : stream_(std::move(stream)),
      origin_(origin),
      isExact_(stream_->player->isExact()),
      points_(frameThreads()),
      blend_(frameThreads()) {
  const DepthCamera& camera = stream_->player->camera();
  size_ = std::size_t{camera.width} * camera.height;
}

const DepthPlayer::Played& DepthSource::playedAt(double time_s) {
  if (!played_ || isExact_ || asked_s_ != time_s) played_.emplace(stream_->player->frameAt(time_s));
  asked_s_ = time_s;
  return *played_;
}

DepthSource::Made DepthSource::wanted(const DepthPlayer::Played& played, double time_s) const {
  const bool isNew = !made_ || made_->serial != played.serial;
  const double setOut_s = isExact_ ? played.time_s : setOut_s_;
  return {.serial = played.serial,
          .isAtRest = (isExact_ || !isNew) && time_s >= setOut_s + played.lasts_s + kSettled_s,
          .isOutdated = stream_->player->isOutdated(time_s)};
}

void DepthSource::makeFrame(double time_s, CloudFrame& frame) {
  if (!stream_->player) return;
  const Stopwatch watch;
  const DepthPlayer::Played& played = playedAt(time_s);
  made_ = wanted(played, time_s);
  if (made_->isOutdated) {
    frame = {.time_s = time_s};
    return;
  }
  measure(played);
  frame = now_->points;
  frame.time_s = played.time_s;
  if (made_->isAtRest)
    blend_.begin(frame);
  else
    blend(played, time_s, time_s + watch.elapsed_us() * 1e-6 + kHandOver_s, frame);
}

// A frame is measured once, however often its points are blended; usually the previous one is known as well.
void DepthSource::measure(const DepthPlayer::Played& played) {
  const auto isOf = [](const std::optional<Measured>& measured, const DepthFrame& frame) {
    return measured && measured->number == frame.number && measured->time_s == frame.time_s;
  };
  if (!isOf(now_, played.frame)) {
    std::swap(now_, before_);
    if (!isOf(now_, played.frame)) measure(played.frame, now_);
  }
  if (played.before && !isOf(before_, *played.before)) measure(*played.before, before_);
}

void DepthSource::measure(const DepthFrame& frame, std::optional<Measured>& measured) {
  if (!measured) measured = Measured{};
  measured->number = frame.number;
  measured->time_s = frame.time_s;
  points_.make(stream_->player->camera(), frame, origin_, measured->points);
  measured->pixels = points_.pixels();
  points_.normalsByPixel(measured->points, size_, measured->normals);
}

void DepthSource::blend(const DepthPlayer::Played& played, double time_s, double ready_s, CloudFrame& frame) {
  const double between_s = played.before ? played.frame.time_s - played.before->time_s : 0;
  const bool follows = between_s > 0 && between_s <= kLongestGap_s && played.lasts_s > 0 &&
                       DepthBlend::canFollow(*played.before, played.frame);
  if (!follows) {
    setOut_s_ = played.time_s;
    return blend_.begin(frame);
  }
  DepthBlend::Step step{.between_s = between_s, .lasts_s = played.lasts_s};
  if (isExact_) {
    // A recording says when the next frame is due, so no displacement remains from the previous frame. Points are made
    // at their current positions.
    step.since_s = std::numeric_limits<double>::infinity();
    step.gone_s = time_s - played.time_s;
    frame.time_s = time_s;
  } else {
    // The surface starts to move once it can be felt, so that it does not jump by its latency.
    frame.time_s = std::max(played.time_s, ready_s);
    step.since_s = frame.time_s - setOut_s_;
    setOut_s_ = frame.time_s;
  }
  blend_.follow(stream_->player->camera(), {.frame = *played.before, .normals = before_->normals}, played.frame,
                origin_, now_->pixels, step, frame);
}

bool DepthSource::hasNewer(double time_s, double /*than_s*/) {
  return stream_->player && wanted(playedAt(time_s), time_s) != made_;
}

}  // namespace palpate
