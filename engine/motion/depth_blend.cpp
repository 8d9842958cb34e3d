#include "engine/motion/depth_blend.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr double kFastest_m_s = 1;   // of a surface that is followed, towards the camera or away
constexpr double kLeastWay = 0.01;   // in depths: what noise alone lets it move
constexpr double kSameDepth = 0.02;  // in depths: pixels side by side that see one surface
// One for each core would take the servo thread its own, where it has no real-time priority.
constexpr unsigned kThreads = 2;

/// A place of a picture, no farther out than the middles of its outermost pixels; nothing beside the picture.
std::optional<DVec2> placeWithin(const DepthCamera& camera, const DVec2& place) {
  const DVec2 last(camera.width - 1, camera.height - 1);
  if (!(place.x > -0.5 && place.y > -0.5 && place.x < last.x + 0.5 && place.y < last.y + 0.5)) return std::nullopt;
  return glm::clamp(place, DVec2(0), last);
}

/// The depth that a frame saw on the ray through a place within its picture: between four pixels where those see one
/// surface, else that of the nearest. 0: none.
double depthAt(const DepthCamera& camera, const DepthFrame& frame, const DVec2& place) {
  const double left = std::min(std::floor(place.x), camera.width - 2.0);
  const double top = std::min(std::floor(place.y), camera.height - 2.0);
  const std::size_t corner = static_cast<std::size_t>(top) * camera.width + static_cast<std::size_t>(left);
  const std::array<double, 4> depths{frame.depth_m[corner], frame.depth_m[corner + 1],
                                     frame.depth_m[corner + camera.width], frame.depth_m[corner + camera.width + 1]};
  const double x = place.x - left, y = place.y - top;
  const auto [nearest, farthest] = std::ranges::minmax(depths);
  if (!(nearest > 0) || !(farthest - nearest <= kSameDepth * nearest)) {
    const double depth = depths[(y < 0.5 ? 0 : 2) + (x < 0.5 ? 0 : 1)];
    return depth > 0 && std::isfinite(depth) ? depth : 0;
  }
  // The inverse of depth is linear in the picture of a plane.
  const double above = (1 - x) / depths[0] + x / depths[1], below = (1 - x) / depths[2] + x / depths[3];
  return 1 / ((1 - y) * above + y * below);
}

/// The place in the frame before.
struct Seen {
  DVec3 place;  // in the world
  std::size_t pixel = 0;
};

std::optional<Seen> seenBefore(const DepthCamera& camera, const DepthFrame& before, const CameraPose& pose,
                               const DVec3& place, double between_s) {
  const DVec3 inCamera = pose.toCamera(place);
  if (!(inCamera.z > 0)) return std::nullopt;
  const std::optional<DVec2> within = placeWithin(camera, camera.pixelOf(inCamera));
  if (!within) return std::nullopt;
  const DVec2 at = *within;
  const double depth = depthAt(camera, before, at);
  const double most = std::max(kLeastWay * inCamera.z, kFastest_m_s * between_s);
  if (!(depth > 0) || !(std::abs(depth - inCamera.z) <= most)) return std::nullopt;
  const auto pixel = static_cast<std::size_t>(std::lround(at.y)) * camera.width + static_cast<std::size_t>(std::lround(at.x));
  return Seen{.place = pose.toWorld(camera.placeAt(at.x, at.y, depth)), .pixel = pixel};
}

}  // namespace

void DepthBlend::begin(CloudFrame& points) {
  points.velocities.clear();
  points.goOn_s = kMostPointsAge_s;
  ways_.clear();
}

void DepthBlend::follow(const DepthCamera& camera, const DepthFrame& before, const DepthFrame& frame, const DVec3& origin,
                        const std::vector<std::uint32_t>& pixels, const Step& step, CloudFrame& points) {
  const double share = ways_.empty() ? 0 : std::clamp(1 - step.since_s / waysGoOn_s_, 0.0, 1.0);  // that is still to come
  left_.swap(ways_);
  ways_.assign(frame.depth_m.size(), Vec3(0));
  waysGoOn_s_ = step.goOn_s;
  points.velocities.assign(points.size(), Vec3(0));
  const double toGo = 1 - std::clamp(step.gone_s / step.goOn_s, 0.0, 1.0);
  points.goOn_s = toGo * step.goOn_s;
  const CameraPose pose = before.pose.value_or(CameraPose{});
  parallelFor(points.size(), kThreads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const DVec3 place = DVec3(points.positions[i]) + origin, normal(points.normals[i]);
      const auto seen = seenBefore(camera, before, pose, place, step.between_s);
      if (!seen) continue;
      const DVec3 late = share > 0 ? share * DVec3(left_[seen->pixel]) : DVec3(0);
      const DVec3 way = glm::dot(normal, place - seen->place + late) * normal;
      ways_[pixels[i]] = Vec3(way);
      points.positions[i] = Vec3(place - toGo * way - origin);
      points.velocities[i] = Vec3(way / step.goOn_s);
    }
  });
}

}  // namespace palpate
