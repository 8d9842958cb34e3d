// The surface in double precision on the CPU: what shaders/lib/weight.glsl and surface.glsl compute.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/contact/surface_kind.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// The surface at a place.
struct SurfaceSample {
  bool defined = false;
  double distance = 0;  ///< signed, model units, positive outside
  DVec3 normal{0};      ///< unit
  std::uint32_t neighbours = 0;
};

struct SurfaceOptions {
  double radius = 0;  ///< support radius, model units; the largest there is
  SurfaceKind kind = SurfaceKind::average;
  bool localRadius = false;  ///< where points lie close, take a smaller one: kSupportSpacings of them
  /// For noisy points: times as large as it would be for clean ones, at least 1, where the surface is flat; where it
  /// turns, the support radius is so many times smaller.
  double widening = 1;
};

/// Wendland's C2 weight of r = distance / support radius in [0, 1].
inline double wendland(double r) {
  const double s = 1.0 - r;
  const double squared = s * s;
  return squared * squared * (4.0 * r + 1.0);
}

/// How much a point counts whose normal's cosine to the felt side is `cosine`: all up to 90 degrees, nothing from 120
/// degrees on, so that the far side of a thin sheet is not felt through it.
inline double facingWeight(double cosine) { return std::clamp(1.0 + 2.0 * cosine, 0.0, 1.0); }

/// The weighted sums over the neighbours of a place that make its surface: one pass for the average (Adamson and Alexa
/// 2003) and the sphere (Guennebaud and Gross 2007; in closed form Guennebaud, Germann, Gross 2008), kSharpPasses for
/// the sharp one, a sphere whose weights let go of points across an edge (Oztireli, Guennebaud, Gross 2009). Everything
/// is relative to the place.
class SurfaceSums {
 public:
  /// `radius`: support radius, model units. `facing`: the side that is felt, or zero. `before`: what the pass before
  /// this one has found, or null.
  SurfaceSums(SurfaceKind kind, double radius, const DVec3& facing, const SurfaceSample* before)
      : kind_(kind), radius_(radius), facing_(facing), sided_(facing != DVec3(0)), before_(before) {}

  /// `offset`: from the place to a neighbour within the support radius.
  void add(const DVec3& offset, const Vec3& normal) {
    const DVec3 d = offset / radius_, n(normal);
    const double squared = glm::dot(d, d);
    double w = wendland(std::sqrt(squared));
    if (sided_) w *= facingWeight(glm::dot(n, facing_));
    if (before_) w *= robustWeight(d, n);
    if (w <= 0) return;
    offsets_ += w * d;
    normals_ += w * n;
    squares_ += w * squared;
    heights_ += w * glm::dot(d, n);
    weights_ += w;
    ++neighbours_;
  }
  SurfaceSample sample() const;

 private:
  double robustWeight(const DVec3& d, const DVec3& normal) const;
  void fitSphere(SurfaceSample& sample) const;

  SurfaceKind kind_;
  double radius_;
  DVec3 facing_;
  bool sided_;
  const SurfaceSample* before_;
  // Of w d and w n, w d.d, w d.n and w; d in support radii.
  DVec3 offsets_{0}, normals_{0};
  double squares_ = 0, heights_ = 0, weights_ = 0;
  std::uint32_t neighbours_ = 0;
};

/// Passes over the neighbours that a kind takes.
inline std::uint32_t surfacePasses(SurfaceKind kind) { return kind == SurfaceKind::sharp ? shared::kSharpPasses : 1; }

/// The support radius that holds kSupportSpacings local spacings, where the weights within `radius` sum up to
/// `weights`: on an even plane the sum is pi / 7 points of the disc.
double localRadius(double radius, double weights, double smallest, double largest);

/// The widening of a support radius of kSupportSpacings that evens the noise of positions out, from how noisy they are
/// (SpacingRange::noise): 1 up to an eighth of a spacing, no more than 2.
double wideningFor(double noise_spacings);

/// How much a normal counts where the turn of a surface of this kind is judged; `cosine`: of it and the side that is
/// felt.
double turnWeight(SurfaceKind kind, double cosine);

/// The support radius between a narrow and a wide one, where the weighted mean of the normals within the wide one is
/// `meanNormal` long.
double wideWhereFlat(double narrow, double wide, double meanNormal);

/// The surface of all neighbours. `forEachNear(radius, visit)` calls visit(offset, normal) for each of them;
/// `facing`: as for SurfaceSums.
template <class ForEachNear>
SurfaceSample surfaceOf(const SurfaceOptions& options, const DVec3& facing, ForEachNear&& forEachNear) {
  const double largest = options.radius / options.widening;
  double radius = largest;
  if (options.localRadius) {
    // Twice, since the first look averages the density over the largest radius; the second may only widen.
    double smallest = static_cast<double>(shared::kLeastLocalRadius) * largest;
    for (int look = 0; look < 2; ++look) {
      double weights = 0;
      forEachNear(radius, [&](const DVec3& offset, const Vec3&) { weights += wendland(glm::length(offset) / radius); });
      smallest = radius = localRadius(radius, weights, smallest, largest);
    }
  }
  if (options.widening > 1) {
    const double wide = options.widening * radius;
    DVec3 normals(0);
    double weights = 0;
    forEachNear(wide, [&](const DVec3& offset, const Vec3& normal) {
      const DVec3 n(normal);
      double w = wendland(std::min(1.0, glm::length(offset) / wide));
      if (facing != DVec3(0)) w *= turnWeight(options.kind, glm::dot(n, facing));
      normals += w * n;
      weights += w;
    });
    radius = wideWhereFlat(radius, wide, weights > 0 ? glm::length(normals) / weights : 0);
  }
  SurfaceSample sample;
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
