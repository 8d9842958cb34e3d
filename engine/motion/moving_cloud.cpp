#include "engine/motion/moving_cloud.hpp"

namespace palpate {

void MovingCloud::makeFrame(double time_s, CloudFrame& frame) {
  const RigidPose pose = motion_.poseAt(time_s);
  frame.time_s = time_s;
  for (std::vector<Vec3>* values : {&frame.positions, &frame.normals, &frame.velocities}) values->resize(size());
  for (std::size_t i = 0; i < size(); ++i) {
    const DVec3 place = pose.moved(DVec3(positions_[i]));
    frame.positions[i] = Vec3(place);
    frame.normals[i] = Vec3(pose.turned(DVec3(normals_[i])));
    frame.velocities[i] = Vec3(pose.velocityAt(place));
  }
}

}  // namespace palpate
