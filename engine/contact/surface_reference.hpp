// The surface in double precision on the CPU: what shaders/lib/weight.glsl and surface.glsl compute.
#pragma once

#include <cstdint>

#include "engine/core/vec.hpp"

namespace palpate {

/// The surface at a place.
struct SurfaceSample {
  bool defined = false;
  double distance = 0;  ///< signed, model units, positive outside
  DVec3 normal{0};      ///< unit
  std::uint32_t neighbours = 0;
};

/// Wendland's C2 weight of r = distance / support radius in [0, 1].
inline double wendland(double r) {
  const double s = 1.0 - r;
  const double squared = s * s;
  return squared * squared * (4.0 * r + 1.0);
}

/// The weighted sums over the neighbours of a place (Adamson and Alexa 2003) that make its surface.
class SurfaceSums {
 public:
  /// `radius`: support radius, model units.
  explicit SurfaceSums(double radius) : inverseRadius_(1.0 / radius) {}

  /// `offset`: from the place to a neighbour within the support radius.
  void add(const DVec3& offset, const Vec3& normal) {
    const double w = wendland(glm::length(offset) * inverseRadius_);
    offsets_ += w * offset;
    normals_ += w * DVec3(normal);
    weights_ += w;
    ++neighbours_;
  }
  SurfaceSample sample() const;

 private:
  double inverseRadius_;
  DVec3 offsets_{0}, normals_{0};
  double weights_ = 0;
  std::uint32_t neighbours_ = 0;
};

/// Inward bias of the averaged surface on a sphere, model units: 0.0694 R^2 / rho for Wendland's C2 weight.
double averageSurfaceBias(double radius, double sphereRadius);

}  // namespace palpate
