#pragma once

#include "engine/cloud/point_cloud.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/motion/rigid_motion.hpp"

namespace palpate {

/// A cloud that moves rigidly, with velocities of its points.
class MovingCloud final : public CloudSource {
 public:
  /// Copies positions and normals of `rest`, which must have normals. `motion`: model units, relative to the cloud's
  /// origin.
  MovingCloud(const PointCloud& rest, const RigidMotion& motion)
      : positions_(rest.positions), normals_(rest.normals), motion_(motion) {}

  std::size_t size() const override { return positions_.size(); }
  void makeFrame(double time_s, CloudFrame& frame) override;

 private:
  std::vector<Vec3> positions_, normals_;  // at rest
  RigidMotion motion_;
};

}  // namespace palpate
