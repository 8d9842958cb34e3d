#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/contact/proxy_tracker.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

/// The fused step in double precision on the CPU: the reference for the GPU. Without patches and budgets.
class ContactReference final : public OneHandQuery, public SurfaceField {
 public:
  /// Keeps a reference to `cloud`, which must have normals.
  ContactReference(const PointCloud& cloud, const SurfaceOptions& options, double friction = 0);
  /// With the averaged surface. `radius`: support radius, model units.
  ContactReference(const PointCloud& cloud, double radius)
      : ContactReference(cloud, SurfaceOptions{.radius = radius}) {}

  Contact answerTo(const Pose& pose, double budget_us) noexcept override;
  SurfaceSample surface(const DVec3& x, const DVec3& facing = DVec3(0)) const override;

 private:
  const PointCloud& cloud_;
  SurfaceOptions options_;
  SortedGrid grid_;
  ProxyTracker tracker_;
};

}  // namespace palpate
