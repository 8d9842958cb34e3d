#include "engine/select/volume_handles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {

namespace {

using Kind = VolumeHandle::Kind;

constexpr double kNear_px = 11;  // of the cursor to a handle

double longest(const DVec3& v) { return std::max({v.x, v.y, v.z}); }

// The ray through a pixel, with a unit direction.
struct Ray {
  DVec3 from, direction;
};
Ray rayThrough(const DVec2& place_px, const Camera& camera, const DVec2& size_px) {
  const DVec3 from = camera.unproject(place_px, 0, size_px);
  return {from, glm::normalize(camera.unproject(place_px, 1, size_px) - from)};
}

// Position along an axis through `centre` that is nearest to the ray through a pixel; 0 if the axis points to the eye.
double alongAxis(const DVec3& centre, const DVec3& axis, const DVec2& place_px, const Camera& camera,
                 const DVec2& size_px) {
  constexpr double kParallel = 1e-4;
  const auto [eye, ray] = rayThrough(place_px, camera, size_px);
  const DVec3 from = eye - centre;
  const double cosine = glm::dot(axis, ray), square = 1 - cosine * cosine;
  return square > kParallel ? (glm::dot(axis, from) - cosine * glm::dot(ray, from)) / square : 0;
}

// Angle of a pixel about an axis through `centre`: in the plane across the axis, or in the picture where that plane is
// seen from its edge.
double angleAbout(const DVec3& centre, const std::array<DVec3, 3>& axes, const DVec2& place_px, const Camera& camera,
                  const DVec2& size_px) {
  constexpr double kEdge = 0.2;
  const auto& [u, v, axis] = axes;
  const auto [eye, ray] = rayThrough(place_px, camera, size_px);
  const double facing = glm::dot(axis, ray);
  if (std::abs(facing) > kEdge) {
    const DVec3 arm = eye + glm::dot(centre - eye, axis) / facing * ray - centre;
    return std::atan2(glm::dot(arm, v), glm::dot(arm, u));
  }
  const auto centre_px = camera.project(centre, size_px);
  if (!centre_px) return 0;
  const DVec2 arm = place_px - DVec2(*centre_px);
  return (glm::dot(axis, camera.towardsViewer(centre)) > 0 ? -1 : 1) * std::atan2(arm.y, arm.x);
}

}  // namespace

std::vector<VolumeHandle> HandledVolume::handles() const {
  std::vector<VolumeHandle> handles{{Kind::centre}};
  if (volume.kind == Volume::Kind::ball) {
    handles.push_back({Kind::size});
    return handles;
  }
  if (volume.kind == Volume::Kind::plane) {
    handles.insert(handles.end(), {{Kind::arrow, 2}, {Kind::ring, 0}, {Kind::ring, 1}});
    return handles;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (movesPoints)
      handles.push_back({Kind::arrow, axis});
    else
      handles.insert(handles.end(), {{Kind::side, axis, 1}, {Kind::side, axis, -1}});
    handles.push_back({Kind::ring, axis});
  }
  if (movesPoints) handles.push_back({Kind::size});
  return handles;
}

DVec3 HandledVolume::placeOf(const VolumeHandle& handle, const Camera& camera) const {
  constexpr double kBeyond = 0.3, kCorner = 1.12;
  const int axis = handle.axis, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double length = longest(volume.half);
  // A flat box has its handles apart, too.
  const DVec3 half = glm::max(volume.half, DVec3(0.1 * length));
  const auto at = [&](const DVec3& own) { return volume.centre + volume.rotation * own; };
  DVec3 own(0);
  switch (handle.kind) {
    case Kind::centre:
      return volume.centre;
    case Kind::side:
      own[axis] = handle.sign * volume.half[axis];
      return at(own);
    case Kind::arrow:
      own[axis] = volume.kind == Volume::Kind::plane ? 0.5 * length : half[axis] + kBeyond * length;
      return at(own);
    case Kind::ring:
      // Of a plane it lies in it, so that dragging it tilts the plane.
      if (volume.kind == Volume::Kind::plane) {
        own[1 - axis] = length;
        return at(own);
      }
      own[u] = kCorner * half[u];
      own[v] = kCorner * half[v];
      return at(own);
    case Kind::size:
      if (volume.kind == Volume::Kind::ball) return volume.centre + volume.half.x * camera.axes().right;
      return at(-kCorner * half);  // rings are at the others
  }
  return volume.centre;
}

std::optional<VolumeHandle> HandledVolume::handleAt(const DVec2& cursor_px, const Camera& camera,
                                                    const DVec2& size_px) const {
  std::optional<VolumeHandle> nearest;
  double least_px = kNear_px;
  for (const VolumeHandle& handle : handles()) {
    const auto place_px = camera.project(placeOf(handle, camera), size_px);
    if (!place_px) continue;
    const double apart_px = glm::distance(DVec2(*place_px), cursor_px);
    if (apart_px < least_px) {
      least_px = apart_px;
      nearest = handle;
    }
  }
  return nearest;
}

Volume HandledVolume::dragged(const VolumeHandle& handle, const Camera& camera, const DVec2& size_px,
                              const DVec2& from_px, const DVec2& to_px) const {
  Volume next = volume;
  const auto centre_px = camera.project(volume.centre, size_px);
  if (!centre_px || from_px == to_px) return next;
  const int k = handle.axis;
  const DVec3 axis = volume.axis(k);
  switch (handle.kind) {
    case Kind::centre:
      next.centre += camera.unproject(to_px, centre_px->z, size_px) - camera.unproject(from_px, centre_px->z, size_px);
      break;
    case Kind::arrow:
    case Kind::side: {
      const double way = alongAxis(volume.centre, axis, to_px, camera, size_px) -
                         alongAxis(volume.centre, axis, from_px, camera, size_px);
      if (handle.kind == Kind::arrow) {
        next.centre += way * axis;
        break;
      }
      // The side does not pass the opposite one, which stays.
      next.half[k] = std::max(0.0, volume.half[k] + 0.5 * handle.sign * way);
      next.centre += handle.sign * (next.half[k] - volume.half[k]) * axis;
      break;
    }
    case Kind::ring: {
      const std::array<DVec3, 3> axes{volume.axis((k + 1) % 3), volume.axis((k + 2) % 3), axis};
      const double angle = angleAbout(volume.centre, axes, to_px, camera, size_px) -
                           angleAbout(volume.centre, axes, from_px, camera, size_px);
      next.rotation = glm::normalize(DQuat(std::cos(0.5 * angle), std::sin(0.5 * angle) * axis) * volume.rotation);
      break;
    }
    case Kind::size: {
      constexpr double kMin = 0.01, kMax = 100;
      const double from = std::max(1.0, glm::distance(from_px, DVec2(*centre_px)));
      next.half *= std::clamp(glm::distance(to_px, DVec2(*centre_px)) / from, kMin, kMax);
      break;
    }
  }
  return next;
}

std::vector<std::array<DVec3, 2>> HandledVolume::edges(const Camera& camera) const {
  std::vector<std::array<DVec3, 2>> edges;
  const auto at = [&](const DVec3& own) { return volume.centre + volume.rotation * (own * volume.half); };
  if (volume.kind == Volume::Kind::ball) {
    constexpr int kParts = 48;
    const Camera::Axes eye = camera.axes();
    // As it is seen: its silhouette, and its equator.
    const DVec3 toEye = camera.towardsViewer(volume.centre);
    const double distance = glm::distance(camera.eye, volume.centre);
    const double ratio =
        camera.isOrthographic() ? 0 : std::min(volume.half.x / std::max(distance, volume.half.x), 1 - 1e-6);
    const DVec3 shift = ratio * volume.half.x * toEye;
    const double radius = volume.half.x * std::sqrt(1 - ratio * ratio);
    for (int k = 0; k < kParts; ++k) {
      const auto on = [&](const DVec3& u, const DVec3& v, double r, int part) {
        const double angle = 2 * std::numbers::pi * part / kParts;
        return r * (std::cos(angle) * u + std::sin(angle) * v);
      };
      const DVec3 side = glm::normalize(glm::cross(toEye, eye.up)), up = glm::normalize(glm::cross(side, toEye));
      edges.push_back(
          {volume.centre + shift + on(side, up, radius, k), volume.centre + shift + on(side, up, radius, k + 1)});
      edges.push_back({volume.centre + on(volume.axis(0), volume.axis(1), volume.half.x, k),
                       volume.centre + on(volume.axis(0), volume.axis(1), volume.half.x, k + 1)});
    }
    return edges;
  }
  const bool isPlane = volume.kind == Volume::Kind::plane;
  for (int axis = 0; axis < (isPlane ? 2 : 3); ++axis)
    for (const double a : {-1.0, 1.0})
      for (const double b : {-1.0, 1.0}) {
        if (isPlane && b > 0) continue;
        DVec3 from(0);
        from[axis] = -1;
        from[isPlane ? 1 - axis : (axis + 1) % 3] = a;
        if (!isPlane) from[(axis + 2) % 3] = b;
        DVec3 to = from;
        to[axis] = 1;
        edges.push_back({at(from), at(to)});
      }
  for (const VolumeHandle& handle : handles())
    if (handle.kind == Kind::arrow) edges.push_back({volume.centre, placeOf(handle, camera)});
  return edges;
}

}  // namespace palpate
