#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/contact/surface_reference.hpp"
#include "engine/core/contact_query.hpp"

namespace palpate {

/// The fused step in double precision on the CPU: the truth that the GPU is held against. Knows nothing of patches or
/// budgets.
class ContactReference final : public ContactQuery {
 public:
  /// Keeps a reference to `cloud`, which must have normals. `radius`: support radius, model units.
  ContactReference(const PointCloud& cloud, double radius);

  Contact query(const Pose& pose, double budget_us) noexcept override;
  /// The surface at a place relative to the cloud's origin.
  SurfaceSample surface(const DVec3& x) const;

 private:
  void walkFreely(const DVec3& hip);
  void track(const DVec3& hip);

  const PointCloud& cloud_;
  double radius_;
  CpuHash hash_;
  bool started_ = false;
  bool touching_ = false;
  std::uint32_t side_ = 0;
  DVec3 lastHip_{0};
  DVec3 proxy_{0};
  SurfaceSample surface_;
};

}  // namespace palpate
