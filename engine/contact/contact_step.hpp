#pragma once

#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

/// Edge of the smallest hash cells that one gather can cover at a support radius; both in the same unit.
double smallestCell(double radius);

/// The fused step: gathers the neighbours of the probe through the hash, evaluates the surface and moves the proxy, in
/// one dispatch of one workgroup. Surface after Adamson and Alexa 2003 with Wendland's C2 weight; proxy by
/// tangent-plane tracking (Salisbury and Tarr 1997), entered where the HIP's motion crosses the surface from outside.
class ContactStep {
 public:
  /// `radius`: support radius, model units. `points`: how many the cloud may have.
  ContactStep(Device& device, double radius, std::uint32_t points);

  /// The next run reads the pose that stands in pose() and leaves its answer in sample(). `logHead`: address of a
  /// uint32 that is copied into the answer.
  void record(CommandList& list, const shared::CloudView& cloud, DeviceAddress logHead) const;

  /// Host-written; valid for the next run.
  shared::ContactPose& pose() const { return pose_.mapped<shared::ContactPose>()[0]; }
  /// Host-read, after a run.
  const shared::ContactSample& sample() const { return sample_.mapped<const shared::ContactSample>()[0]; }
  /// The state on the GPU, for passes that follow in the same tick.
  const Buffer& state() const { return state_; }
  double radius() const { return radius_; }

 private:
  double radius_;
  ComputePipeline step_;
  Buffer pose_, state_, sample_, spill_;
};

}  // namespace palpate
