#include "engine/contact/contact_reference.hpp"

namespace palpate {

ContactReference::ContactReference(const PointCloud& cloud, double radius)
    : cloud_(cloud),
      radius_(radius),
      hash_(cloud.positions, makeHashGrid(Vec3(0), radius, cloud.size())),
      tracker_(radius) {}

SurfaceSample ContactReference::surface(const DVec3& x) const {
  SurfaceSums sums(radius_);
  hash_.forEachNear(x, radius_, [&](std::uint32_t i) { sums.add(DVec3(cloud_.positions[i]) - x, cloud_.normals[i]); });
  return sums.sample();
}

Contact ContactReference::query(const Pose& pose, double) noexcept {
  tracker_.follow(*this, pose.hip - cloud_.origin);
  return {.proxy = tracker_.proxy() + cloud_.origin,
          .normal = tracker_.surface().normal,
          .touching = tracker_.touching(),
          .fresh = true,
          .valid = true,
          .neighbours = tracker_.surface().neighbours};
}

}  // namespace palpate
