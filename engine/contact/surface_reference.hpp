#pragma once

#include "engine/spatial/cpu_hash.hpp"

namespace palpate {

/// The surface at a place: what shaders/lib/surface.glsl computes, in double precision.
struct SurfaceSample {
  bool defined = false;
  double distance = 0;  ///< signed, model units, positive outside
  DVec3 normal{0};      ///< unit
  std::uint32_t neighbours = 0;
};

/// Wendland's C2 weight of r = distance / support radius in [0, 1].
double wendland(double r);

/// `normals`: one unit normal per point of the hash, in file order. `radius`: support radius, model units.
SurfaceSample surfaceAt(const CpuHash& hash, std::span<const Vec3> positions, std::span<const Vec3> normals,
                        const DVec3& x, double radius);

/// Inward bias of the averaged surface on a sphere, model units: 0.0694 R^2 / rho for Wendland's C2 weight.
double averageSurfaceBias(double radius, double sphereRadius);

}  // namespace palpate
