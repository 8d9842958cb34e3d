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
    touching_ = before.touching;
    sticking_ = before.sticking;
    face_ = before.face;
    facing_ = before.facing;
    proxy_ = before.proxy;
    if (!touching_) walkFreely(before);
    if (!touching_) return;
    track(before.touching);
    if (touching_) return;
    proxy_ = vec3(0.0f);
    surface_ = feel(proxy_);
  }

  /// Thread 0 writes the state for the next tick and the answer for the host.
  __device__ void write() const {
    if (threadIdx.x != 0) return;
    const uint touching = !touching_ ? kFree : sticking_ ? kSticking : kSliding;
    ContactSample sample{.spring = proxy_,
                         .touching = touching,
                         .normal = surface_.normal,
                         .neighbours = surface_.neighbours,
                         .tick = pose_.tick,
                         .trackingSteps = trackingSteps_,
                         .logHead = 0,
                         .flags = (patch_.thinned() ? kSampleThinned : 0) | face_ << kSampleFaceShift};
    sample.seal = sealOf(sample);
    args_.answer->sample = sample;
    *args_.state = {
        .lastHip = pose_.hip, .touching = touching, .spring = proxy_, .face = face_, .facing = facing_, .started = 1};
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
    if (touching_ && face_ == kFaceBehind) {
      surface.normal = -surface.normal;
      surface.distance = -surface.distance;
    }
    return surface;
  }

  // Steps along the segment of the HIP's motion and touches where it crosses the surface.
  __device__ void walkFreely(const Before& before) {
    const float way = wayOf(before, args_.radius);
    const uint steps = substepsOn(way);
    const bool traced = before.started && way <= float(kMaxSubsteps);
    vec3 last = before.lastHip;
    for (uint s = 1; s <= steps && !touching_; ++s) {
      const vec3 x = freePlace(before, s, steps);
      surface_ = feel(x);
      const bool inFront = surface_.distance > 0.0f;
      if (surface_.defined && crosses(face_, inFront)) {
        touching_ = true;
        sticking_ = true;
        proxy_ = last;
      } else {
        face_ = faceAfter(face_, surface_.defined, surface_.ends, inFront, traced);
      }
      last = x;
    }
  }

  // Projects the proxy onto the surface and follows the HIP in the tangent plane until it rests. `touched`: also
  // touching in the last tick, which evaluated the surface at the proxy.
  __device__ void track(bool touched) {
    const float longest = kLongestStep * args_.radius;
    const float arrived = kConvergence * args_.radius;
    vec3 firstSlide(0.0f);
    if (touched && facing_ != vec3(0.0f))
      firstSlide = slideAlong(face_ == kFaceBehind ? -facing_ : facing_, proxy_, args_.friction, sticking_);
    auto tracking = trackingFrom(firstSlide, sticking_, arrived);
    if (tracking.slid) proxy_ += shortened(firstSlide, longest);
    surface_ = feel(proxy_);
    for (; trackingSteps_ < kMaxTrackingSteps && surface_.defined; ++trackingSteps_) {
      const auto step = nextStep(tracking, proxy_, surface_.normal, surface_.distance, args_.friction);
      if (step.size < arrived) break;
      proxy_ += takeStep(tracking, step, longest);
      if (step.size < kLastStep * args_.radius) break;
      surface_ = feel(proxy_);
    }
    sticking_ = !tracking.slid;
    if (!surface_.defined) {
      touching_ = false;
      face_ = kFaceInside;  // lost inside: not caught again when leaving
    } else if (dot(proxy_, surface_.normal) < 0.0f) {
      touching_ = false;
    }
  }

  const StepArgs& args_;
  ContactPose pose_;
  Patch patch_;
  Surface surface_{};
  vec3 proxy_{0.0f}, facing_{0.0f};
  bool touching_ = false, sticking_ = false;
  uint face_ = kFaceUnknown;
  uint trackingSteps_ = 0;
};

}  // namespace palpate::cu
