#include "engine/contact/contact_reference.hpp"

namespace palpate {

ContactReference::ContactReference(const PointCloud& cloud, const SurfaceOptions& options, double friction)
    : cloud_(cloud),
      options_(options),
      hash_(cloud.positions, makeHashGrid(Vec3(0), options.radius, cloud.size())),
      tracker_(options.radius, friction) {}

SurfaceSample ContactReference::surface(const DVec3& x, const DVec3& facing) const {
  return surfaceOf(options_, facing, [&](double radius, auto&& visit) {
    hash_.forEachNear(x, radius, [&](std::uint32_t i) { visit(DVec3(cloud_.positions[i]) - x, cloud_.normals[i]); });
  });
}

Contact ContactReference::answerTo(const Pose& pose, double) noexcept {
  tracker_.follow(*this, pose.hip - cloud_.origin);
  return {.proxy = tracker_.proxy() + cloud_.origin,
          .normal = tracker_.surface().normal,
          .touching = tracker_.touching(),
          .fresh = true,
          .valid = true,
          .isWithin = tracker_.isLost(),
          .neighbours = tracker_.surface().neighbours};
}

}  // namespace palpate
