// The surface in double precision on the CPU: the formulas of shaders/shared/surface.h, summed over neighbours.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/contact/surface_kind.hpp"
#include "engine/core/vec.hpp"
#include "shaders/shared/surface.h"

namespace palpate {

/// The surface at a position.
using SurfaceSample = shared::SurfaceOf<double>;

struct SurfaceOptions {
  double radius = 0;  ///< support radius, model units; the maximum
  SurfaceKind kind = SurfaceKind::average;
  bool localRadius = false;  ///< use a smaller radius where points are dense: kSupportSpacings of them
  /// For noisy points: factor of `radius` over that of clean points, at least 1, where the surface is flat; where the
  /// surface curves, the support radius is divided by it.
  double widening = 1;
};

using shared::wendland;

/// The weighted sums over the neighbours of a position that define its surface: one pass for average and sphere,
/// kSharpPasses for sharp. Everything is relative to the position.
class SurfaceSums {
 public:
  /// `radius`: support radius, model units. `facing`: normal of the face that is felt, or zero. `before`: result of the
  /// previous pass, or null.
  SurfaceSums(SurfaceKind kind, double radius, const DVec3& facing, const SurfaceSample* before)
      : kind_(kind), radius_(radius), facing_(facing), sided_(facing != DVec3(0)), before_(before) {}

  /// `offset`: from the position to a neighbour within the support radius.
  void add(const DVec3& offset, const Vec3& normal) {
    const DVec3 d = offset / radius_, n(normal);
    const double squared = glm::dot(d, d);
    double w = wendland(std::sqrt(squared));
    if (sided_) w *= shared::facingWeight(glm::dot(n, facing_));
    if (before_) w *= shared::robustWeight(before_->normal, before_->distance / radius_, d, n);
    if (w <= 0) return;
    sums_.offsets += w * DVec4(d, 1.0);
    sums_.normals += DVec4(w * n, 1.0);
    sums_.products += w * DVec2(squared, glm::dot(d, n));
  }
  SurfaceSample sample() const;

 private:
  SurfaceKind kind_;
  double radius_;
  DVec3 facing_;
  bool sided_;
  const SurfaceSample* before_;
  shared::SurfaceSumsOf<double> sums_{};
};

/// Number of passes over the neighbours for a kind.
inline std::uint32_t surfacePasses(SurfaceKind kind) { return kind == SurfaceKind::sharp ? shared::kSharpPasses : 1; }

/// The widening of a support radius of kSupportSpacings that averages out the noise of positions (SpacingRange::noise):
/// 1 up to an eighth of a spacing, at most 2.
double wideningFor(double noise_spacings);

/// The surface of all neighbours. `forEachNear(radius, visit)` calls visit(offset, normal) for each of them; `facing`:
/// as for SurfaceSums.
template <class ForEachNear>
SurfaceSample surfaceOf(const SurfaceOptions& options, const DVec3& facing, ForEachNear&& forEachNear) {
  const double largest = options.radius / options.widening;
  double radius = largest;
  if (options.localRadius) {
    // Twice, since the first pass averages the density over the largest radius; the second may only widen.
    double smallest = static_cast<double>(shared::kMinLocalRadius) * largest;
    for (int pass = 0; pass < 2; ++pass) {
      double weights = 0;
      forEachNear(radius, [&](const DVec3& offset, const Vec3&) { weights += wendland(glm::length(offset) / radius); });
      smallest = radius = shared::localRadius(radius, weights, smallest, largest);
    }
  }
  if (options.widening > 1) {
    const double wide = options.widening * radius;
    DVec3 normals(0);
    double weights = 0;
    forEachNear(wide, [&](const DVec3& offset, const Vec3& normal) {
      const DVec3 n(normal);
      double w = wendland(std::min(1.0, glm::length(offset) / wide));
      if (facing != DVec3(0)) w *= shared::turnWeight(static_cast<shared::uint>(options.kind), glm::dot(n, facing));
      normals += w * n;
      weights += w;
    });
    radius = shared::wideWhereFlat(radius, wide, weights > 0 ? glm::length(normals) / weights : 0);
  }
  SurfaceSample sample{};
  for (std::uint32_t pass = 0; pass < surfacePasses(options.kind); ++pass) {
    const SurfaceSample before = sample;
    SurfaceSums sums(options.kind, radius, facing, pass > 0 ? &before : nullptr);
    forEachNear(radius, [&](const DVec3& offset, const Vec3& normal) { sums.add(offset, normal); });
    sample = sums.sample();
    if (!sample.defined) break;
  }
  return sample;
}

/// Inward bias of the averaged surface on a sphere, model units: 0.0694 R^2 / rho for Wendland's C2 weight.
double averageSurfaceBias(double radius, double sphereRadius);

}  // namespace palpate
