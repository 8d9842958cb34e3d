// What an edit must come to, in double precision, for the tests of every back end.
#pragma once

#include <algorithm>

#include "engine/cloud/eigen3.hpp"
#include "engine/contact/surface_reference.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/spatial/cpu_hash.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

// Where the push sends a point: shaders/edit/push.comp in double precision.
inline DVec3 pushed(const DVec3& p, const DVec3& hip, const DVec3& spring, const PushOptions& options,
                    double longestMove) {
  const double depth = glm::length(spring);
  if (depth <= options.tau) return p;
  const DVec3 outward = spring / depth;
  const DVec3 center = hip + (options.tau + options.toolRadius) * outward;
  const double distance = glm::distance(p, center);
  if (distance >= options.toolRadius) return p;
  const DVec3 away = distance > 0 ? (p - center) / distance : -outward;
  return p + std::min(options.beta * (options.toolRadius - distance), longestMove) * away;
}

struct FittedNormal {
  DVec3 normal{0};
  double flatness = 0;  // smallest over middle eigenvalue: near 1 the direction means nothing
};

inline FittedNormal fitted(const CpuHash& hash, std::span<const Vec3> positions, const DVec3& center, const DVec3& old,
                           double radius) {
  double weights = 0;
  DVec3 mean(0);
  SymmetricMatrix3 moment{};
  std::size_t neighbours = 0;
  hash.forEachNear(center, radius, [&](std::uint32_t i) {
    const DVec3 d = DVec3(positions[i]) - center;
    const double w = wendland(glm::length(d) / radius);
    weights += w;
    mean += w * d;
    moment.xx += w * d.x * d.x;
    moment.xy += w * d.x * d.y;
    moment.xz += w * d.x * d.z;
    moment.yy += w * d.y * d.y;
    moment.yz += w * d.y * d.z;
    moment.zz += w * d.z * d.z;
    ++neighbours;
  });
  if (neighbours < shared::kMinNeighbours) return {old, 0};
  mean /= weights;
  SymmetricMatrix3 covariance = moment;
  for (double* entry : {&covariance.xx, &covariance.xy, &covariance.xz, &covariance.yy, &covariance.yz, &covariance.zz})
    *entry /= weights;
  covariance.xx -= mean.x * mean.x;
  covariance.xy -= mean.x * mean.y;
  covariance.xz -= mean.x * mean.z;
  covariance.yy -= mean.y * mean.y;
  covariance.yz -= mean.y * mean.z;
  covariance.zz -= mean.z * mean.z;
  const Eigen3 eigen = eigenSymmetric(covariance);
  const DVec3 normal = eigen.vectors[0];
  return {glm::dot(normal, old) < 0 ? -normal : normal, eigen.values[0] / eigen.values[1]};
}

}  // namespace palpate
