// Evenness of the points of a surface.
#pragma once

#include <algorithm>
#include <numbers>

#include "engine/contact/contact_reference.hpp"

namespace palpate {

/// For a part of a cloud, in its spacings.
struct SurfaceGaps {
  double widest = 0;   ///< radius of the largest empty circle on the surface that is surrounded by points, up to 2.5
  double closest = 0;  ///< distance of the two nearest points on the same side
  std::size_t points = 0;
};

/// Tests positions around every point for which `counts(position)` is true.
class SurfaceGapFinder {
 public:
  SurfaceGapFinder(const PointCloud& cloud, double radius, double spacing)
      : cloud_(cloud),
        surface_(cloud, radius),
        grid_(makeHashGrid(Vec3(0), 2 * spacing, cloud.size()), 1),
        spacing_(spacing) {
    grid_.build(cloud.positions);
  }

  template <class Counts>
  SurfaceGaps find(Counts&& counts) const {
    SurfaceGaps gaps{.closest = kReach};
    for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
      const DVec3 place(cloud_.positions[i]), normal(cloud_.normals[i]);
      if (!counts(place)) continue;
      ++gaps.points;
      gaps.closest = std::min(gaps.closest, nearest(place, normal, i));
      const Frame3 frame = frameAround(normal);
      for (const double r : {0.8, 1.2, 1.6, 2.0, 2.4})
        for (int k = 0; k < 12; ++k) {
          const double angle = k * std::numbers::pi / 6;
          const auto on =
              onSurface(place + r * spacing_ * (std::cos(angle) * frame.u + std::sin(angle) * frame.v), normal);
          if (on.defined && isSurrounded(on.place, on.normal))
            gaps.widest = std::max(gaps.widest, nearest(on.place, DVec3(0), kNobody));
        }
    }
    return gaps;
  }

 private:
  static constexpr double kReach = 4;  // spacings
  static constexpr std::uint32_t kNobody = ~0u;
  struct Place {
    bool defined = false;
    DVec3 place{0}, normal{0};
  };

  Place onSurface(DVec3 x, const DVec3& facing) const {
    SurfaceSample sample{};
    for (int step = 0; step < 4; ++step) {
      sample = surface_.surface(x, facing);
      if (!sample.defined) return {};
      x -= sample.distance * sample.normal;
    }
    return {true, x, sample.normal};
  }

  // Distance to the nearest point that faces the same way as `facing` (any, for zero), in spacings.
  double nearest(const DVec3& x, const DVec3& facing, std::uint32_t but) const {
    double best = kReach;
    grid_.forEachNear(x, kReach * spacing_, [&](const SortedGrid::Placed& point) {
      const std::uint32_t j = point.number;
      if (j != but && (facing == DVec3(0) || glm::dot(facing, DVec3(cloud_.normals[j])) > 0))
        best = std::min(best, glm::distance(x, DVec3(cloud_.positions[j])) / spacing_);
    });
    return best;
  }

  // Not beyond a border: the points of the same sheet leave no angle wider than at the side of a hole.
  bool isSurrounded(const DVec3& x, const DVec3& normal) const {
    constexpr double kWidestAngle = 2.2;
    const Frame3 frame = frameAround(normal);
    std::vector<double> angles;
    grid_.forEachNear(x, 3.5 * spacing_, [&](const SortedGrid::Placed& point) {
      const DVec3 d = DVec3(point.position) - x;
      if (glm::dot(DVec3(cloud_.normals[point.number]), normal) > 0.3 && std::abs(glm::dot(d, normal)) < spacing_)
        angles.push_back(std::atan2(glm::dot(d, frame.v), glm::dot(d, frame.u)));
    });
    if (angles.size() < 3) return false;
    std::ranges::sort(angles);
    double widest = angles.front() + 2 * std::numbers::pi - angles.back();
    for (std::size_t k = 1; k < angles.size(); ++k) widest = std::max(widest, angles[k] - angles[k - 1]);
    return widest < kWidestAngle;
  }

  const PointCloud& cloud_;
  ContactReference surface_;
  SortedGrid grid_;
  double spacing_;
};

}  // namespace palpate
