// One pose answered by one block: the state machine of shaders/contact/contact_step.comp. All threads follow the same
// path with the same numbers; positions are relative to the HIP. There is no work budget here: the numbers of sub-steps
// and tracking steps bound a tick, and no driver stops a long loop.
#pragma once

#include "engine/cuda/surface.cuh"

namespace palpate::cu {

class ContactStep {
 public:
  __device__ ContactStep(const StepArgs& args, const CloudView& cloud, SharedPatch& memory, const ContactPose& pose)
      : args_(args), pose_(pose), patch_(args, cloud, memory, pose.hip) {}

  /// For gathers done by other kernels.
  __device__ void takeOver(const Gather& gather) { patch_.takeOver(gather, args_.slots); }

  __device__ void run() {
    const Before before = stateBefore(*args_.state, pose_.hip);
    // At the same position as other kernels' gathers, so that all methods get the same bits.
    if (!patch_.gathered()) patch_.gatherAround(firstPlace(before, args_.radius), patchReach(args_.radius));
    const uint substeps = substepsOn(wayOf(before, args_.radius));
    const bool traced = before.started && wayOf(before, args_.radius) <= float(kMaxSubsteps);
    facing_ = before.facing;
    tick_ = tickFrom(before.touching, before.sticking, before.face, facing_, before.lastHip, before.proxy, vec3(0.0f),
                     args_.radius, args_.friction);
    do {
      if (tick_.purpose == kWalks) tick_.at = freePlace(before, tick_.substep, substeps);
      surface_ = feel(tick_.at);
    } while (goesOn(tick_, surface_, vec3(0.0f), args_.radius, args_.friction, substeps, traced, false));
  }

  /// Thread 0 writes the state for the next tick and the answer for the host.
  __device__ void write() const {
    if (threadIdx.x != 0) return;
    const uint touching = !tick_.touching ? kFree : tick_.sticking ? kSticking : kSliding;
    const vec3 proxy = tick_.touching ? tick_.proxy : vec3(0.0f);
    ContactSample sample{.spring = proxy,
                         .touching = touching,
                         .normal = surface_.normal,
                         .neighbours = surface_.neighbours,
                         .tick = pose_.tick,
                         .trackingSteps = tick_.trackingSteps,
                         .logHead = 0,
                         .flags = (patch_.thinned() ? kSampleThinned : 0) | tick_.face << kSampleFaceShift};
    sample.seal = sealOf(sample);
    args_.answer->sample = sample;
    *args_.state = {.lastHip = pose_.hip,
                    .touching = touching,
                    .spring = proxy,
                    .face = tick_.face,
                    .facing = facing_,
                    .started = 1};
  }

 private:
  // The surface at a position, from the points of the face that was felt last; past the edge of such a sheet all points
  // count. Its outside is the felt face. Gathers a new patch if the position has left the old one.
  __device__ Surface feel(const vec3& x) {
    const float slack = kPatchSlack * args_.radius;
    if (glm::distance(x, patch_.centre()) > slack) patch_.gatherAround(x, patchReach(args_.radius));
    Surface surface = surfaceAt(patch_, x - patch_.centre(), args_.radius, facing_);
    if (!surface.defined && facing_ != vec3(0.0f))
      surface = surfaceAt(patch_, x - patch_.centre(), args_.radius, vec3(0.0f));
    facing_ = surface.normal;
    if (tick_.touching && tick_.face == kFaceBehind) {
      surface.normal = -surface.normal;
      surface.distance = -surface.distance;
    }
    return surface;
  }

  const StepArgs& args_;
  ContactPose pose_;
  Patch patch_;
  Surface surface_{};
  vec3 facing_{0.0f};
  ProxyTickOf<float> tick_{};
};

}  // namespace palpate::cu
