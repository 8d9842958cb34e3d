#include "engine/contact/contact_reference.hpp"

namespace palpate {

ContactReference::ContactReference(const PointCloud& cloud, const SurfaceOptions& options, double friction)
    : cloud_(cloud),
      options_(options),
      grid_(makeHashGrid(Vec3(0), options.radius, cloud.size()), 1),
      tracker_(options.radius, friction) {
  grid_.build(cloud.positions);
}

SurfaceSample ContactReference::surface(const DVec3& x, const DVec3& facing) const {
  return surfaceOf(options_, facing, [&](double radius, auto&& visit) {
    grid_.forEachNear(x, radius, [&](const SortedGrid::Placed& point) {
      visit(DVec3(point.position) - x, cloud_.normals[point.number]);
    });
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
