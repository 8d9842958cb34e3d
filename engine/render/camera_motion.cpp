#include "engine/render/camera_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "engine/core/check.hpp"

namespace palpate {

namespace {

constexpr double kSteepest = 0.995;  // cosine between the view and up: beyond it left and right would flip

// Rotation about a unit axis (Rodrigues 1840).
DVec3 turned(const DVec3& v, const DVec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return c * v + s * glm::cross(axis, v) + (1 - c) * glm::dot(axis, v) * axis;
}

// Uniform spline through four values, from the second at 0 to the third at 1 (Catmull and Rom 1974).
template <class T>
T spline(const std::array<T, 4>& v, double t) {
  return 0.5 * (2.0 * v[1] + t * (v[2] - v[0]) + t * t * (2.0 * v[0] - 5.0 * v[1] + 4.0 * v[2] - v[3]) +
                t * t * t * (3.0 * v[1] - v[0] - 3.0 * v[2] + v[3]));
}

DQuat directionOf(const Camera& camera) {
  const Camera::Axes axes = camera.axes();
  return glm::quat_cast(glm::dmat3(axes.right, axes.up, -axes.forward));
}

}  // namespace

Camera orbited(const Camera& camera, const DVec3& pivot, const DVec2& way_px, const DVec2& size_px) {
  const double perPixel = std::numbers::pi / std::max(size_px.y, 1.0);
  const DVec3 up = glm::normalize(camera.up);
  Camera result = camera;
  const auto turn = [&](const DVec3& axis, double angle) {
    result.eye = pivot + turned(result.eye - pivot, axis, angle);
    result.target = pivot + turned(result.target - pivot, axis, angle);
  };
  turn(up, -way_px.x * perPixel);
  const Camera::Axes axes = result.axes();
  const double steep = std::asin(std::clamp(glm::dot(axes.forward, up), -1.0, 1.0));
  const double most = std::asin(kSteepest);
  turn(axes.right, std::clamp(steep - way_px.y * perPixel, std::min(-most, steep), std::max(most, steep)) - steep);
  return result;
}

Camera panned(const Camera& camera, double depth, const DVec2& way_px, const DVec2& size_px) {
  const Camera::Axes axes = camera.axes();
  const DVec3 way = camera.pixelSize(depth, size_px.y) * (-way_px.x * axes.right + way_px.y * axes.up);
  Camera result = camera;
  result.eye += way;
  result.target += way;
  return result;
}

Camera walked(const Camera& camera, const DVec3& way) {
  const Camera::Axes axes = camera.axes();
  const DVec3 step = way.x * axes.right + way.y * glm::normalize(camera.up) + way.z * axes.forward;
  Camera result = camera;
  result.eye += step;
  result.target += step;
  if (camera.isOrthographic()) result.height *= std::exp(-way.z / glm::distance(camera.eye, camera.target));
  return result;
}

Camera zoomed(const Camera& camera, const DVec3& point, double factor, double nearest, double farthest) {
  const double distance = camera.isOrthographic() ? camera.height : glm::distance(camera.eye, point);
  if (!(distance > 0)) return camera;
  const double left =
      std::clamp(factor * distance, std::min(nearest, distance), std::max(farthest, distance)) / distance;
  Camera result = camera;
  if (camera.isOrthographic()) {
    const DVec3 forward = camera.axes().forward, away = point - camera.eye;
    const DVec3 way = (1 - left) * (away - glm::dot(away, forward) * forward);
    result.eye += way;
    result.target += way;
    result.height = left * camera.height;
    return result;
  }
  result.eye = point + left * (camera.eye - point);
  result.target = point + left * (camera.target - point);
  return result;
}

Camera projecting(const Camera& camera, bool orthographic) {
  if (orthographic == camera.isOrthographic()) return camera;
  Camera result = camera;
  const double perDistance = 2 * std::tan(glm::radians(camera.fov_deg) / 2);
  if (orthographic) {
    result.height = perDistance * glm::distance(camera.eye, camera.target);
  } else {
    result.height = 0;
    result.eye = camera.target - camera.height / perDistance * camera.axes().forward;
  }
  return result;
}

Camera alongCameras(std::span<const Camera> cameras, double at) {
  PALPATE_CHECK(!cameras.empty());
  const auto last = static_cast<std::ptrdiff_t>(cameras.size()) - 1;
  const std::ptrdiff_t leg =
      std::clamp(static_cast<std::ptrdiff_t>(std::floor(at)), std::ptrdiff_t{0}, std::max(last - 1, std::ptrdiff_t{0}));
  const double t = std::clamp(at - static_cast<double>(leg), 0.0, 1.0);
  std::array<DVec3, 4> targets, eyes;
  std::array<DQuat, 4> directions;
  std::array<double, 4> distances{}, heights{}, fields{};
  for (std::size_t k = 0; k < 4; ++k) {
    const Camera& each = cameras[static_cast<std::size_t>(
        std::clamp(leg + static_cast<std::ptrdiff_t>(k) - 1, std::ptrdiff_t{0}, last))];
    targets[k] = each.target;
    eyes[k] = each.eye;
    directions[k] = directionOf(each);
    if (k > 0 && glm::dot(directions[k - 1], directions[k]) < 0) directions[k] = -directions[k];
    distances[k] = std::log(glm::distance(each.eye, each.target));
    heights[k] = each.isOrthographic() ? std::log(each.height) : 0;
    fields[k] = each.fov_deg;
  }
  const glm::dmat3 axes = glm::mat3_cast(glm::normalize(spline(directions, t)));
  Camera camera = cameras.front();
  const DVec3 away = std::exp(spline(distances, t)) * axes[2];
  const bool turnsHead = glm::distance(eyes[1], eyes[2]) < glm::distance(targets[1], targets[2]);
  camera.target = turnsHead ? spline(eyes, t) - away : spline(targets, t);
  camera.eye = camera.target + away;
  camera.up = axes[1];
  camera.fov_deg = spline(fields, t);
  if (camera.isOrthographic()) camera.height = std::exp(spline(heights, t));
  return camera;
}

Camera recentred(const Camera& camera, const DVec3& point) {
  const DVec3 forward = camera.axes().forward;
  const double depth = glm::dot(point - camera.eye, forward);
  Camera result = camera;
  result.eye = point - (depth > 0 ? depth : glm::distance(camera.eye, camera.target)) * forward;
  result.target = point;
  return result;
}

namespace {

// Looks at the target from a direction (unit vector).
Camera lookingFrom(const Camera& camera, DVec3 side, UpAxis up, const DVec3& front) {
  Camera result = camera;
  result.up = directionOf(up);
  constexpr double kAlong = 1 - 1e-9;
  if (const double along = glm::dot(side, result.up); std::abs(along) > kAlong) {
    // tilted by a millionth, so that a later rotation has an axis
    constexpr double kSteep = 1 - 1e-12;
    side = kSteep * side + std::sqrt(1 - kSteep * kSteep) * front;
  }
  result.eye = camera.target + glm::distance(camera.eye, camera.target) * side;
  return result;
}

}  // namespace

Camera alongAxis(const Camera& camera, int axis, bool fromAbove, UpAxis up, const DVec3& front) {
  DVec3 side(0);
  side[axis] = fromAbove ? 1 : -1;
  return lookingFrom(camera, side, up, front);
}

Camera fromSide(const Camera& camera, ModelSide side, UpAxis up, const DVec3& front) {
  return lookingFrom(camera, directionTo(side, up, front), up, front);
}

}  // namespace palpate
