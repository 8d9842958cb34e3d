// One pose answered by one block: the state machine of shaders/contact/contact_step.comp. Every thread follows the same
// path with the same numbers; places are relative to the HIP. There is no work budget here: the numbers of sub-steps
// and tracking steps bound a tick, and no driver stops a long loop.
#pragma once

#include "engine/cuda/surface.cuh"

namespace palpate::cu {

class ContactStep {
 public:
  __device__ ContactStep(const StepArgs& args, const CloudView& cloud, SharedPatch& memory, const ContactPose& pose)
      : args_(args), pose_(pose), patch_(args, cloud, memory, pose.hip) {}

  /// For gathers that other kernels have done.
  __device__ void takeOver(const Gather& gather) { patch_.takeOver(gather, args_.slots); }

  __device__ void run() {
    const Before before = stateBefore(*args_.state, pose_.hip);
    touching_ = before.touching;
    side_ = before.side;
    proxy_ = before.proxy;
    if (!touching_) walkFreely(before);
    if (!touching_) return;
    track();
    if (touching_) return;
    proxy_ = vec3(0.0f);
    surface_ = surfaceNear(proxy_);
  }

  /// Thread 0 leaves the state for the next tick and the answer for the host.
  __device__ void write() const {
    if (threadIdx.x != 0) return;
    ContactSample sample{.spring = proxy_,
                         .touching = touching_ ? 1u : 0u,
                         .normal = surface_.normal,
                         .neighbours = surface_.neighbours,
                         .tick = pose_.tick,
                         .trackingSteps = trackingSteps_,
                         .logHead = 0,
                         .flags = patch_.thinned() ? kSampleThinned : 0};
    sample.seal = sealOf(sample);
    args_.answer->sample = sample;
    *args_.state = {.lastHip = pose_.hip,
                    .touching = touching_ ? 1u : 0u,
                    .spring = proxy_,
                    .side = side_,
                    .facing = vec3(0.0f),
                    .started = 1};
  }

 private:
  // The surface at a place; gathers a new patch when the place has left the old one.
  __device__ Surface surfaceNear(const vec3& x) {
    const float slack = kPatchSlack * args_.radius;
    if (!patch_.gathered() || glm::distance(x, patch_.centre()) > slack)
      patch_.gatherAround(x, patchReach(args_.radius));
    return surfaceAt(patch_, x - patch_.centre(), args_.radius);
  }

  __device__ static vec3 shortened(const vec3& step, float longest) {
    const float size = glm::length(step);
    return size > longest ? step * (longest / size) : step;
  }

  // Walks the segment of the HIP's motion and touches where it comes from outside to inside.
  __device__ void walkFreely(const Before& before) {
    const uint steps = freeSteps(before, kLongestStep * args_.radius);
    vec3 outside = before.lastHip;
    for (uint s = 1; s <= steps && !touching_; ++s) {
      const vec3 x = freePlace(before, s, steps);
      surface_ = surfaceNear(x);
      if (!surface_.defined) {
        side_ = kSideUnknown;
      } else if (surface_.distance > 0.0f) {
        side_ = kSideOutside;
        outside = x;
      } else if (side_ == kSideOutside) {
        touching_ = true;
        proxy_ = outside;
      } else {
        side_ = kSideInside;
      }
    }
  }

  // Projects the proxy onto the surface and follows the HIP in the tangent plane until it rests (Salisbury and Tarr
  // 1997).
  __device__ void track() {
    const float longest = kLongestStep * args_.radius;
    const float arrived = kConvergence * args_.radius;
    vec3 lastSlide(0.0f);
    float relaxation = 1.0f;
    surface_ = surfaceNear(proxy_);
    for (; trackingSteps_ < kMaxTrackingSteps && surface_.defined; ++trackingSteps_) {
      const vec3 n = surface_.normal;
      const vec3 lift = -surface_.distance * n;
      const vec3 slide = glm::dot(proxy_, n) * n - proxy_;
      const float step = glm::max(glm::length(lift), glm::length(slide));
      if (step < arrived) break;
      // A slide that turns back has overshot, as it does in a hollow narrower than the HIP is deep.
      if (glm::dot(slide, lastSlide) < 0.0f) relaxation *= 0.5f;
      lastSlide = slide;
      proxy_ += shortened(lift, longest) + shortened(relaxation * slide, longest);
      if (step < kLastStep * args_.radius) break;
      surface_ = surfaceNear(proxy_);
    }
    if (!surface_.defined) {
      touching_ = false;
      side_ = kSideUnknown;
    } else if (glm::dot(proxy_, surface_.normal) < 0.0f) {
      touching_ = false;
      side_ = kSideOutside;
    }
  }

  const StepArgs& args_;
  ContactPose pose_;
  Patch patch_;
  Surface surface_{};
  vec3 proxy_{0.0f};
  bool touching_ = false;
  uint side_ = kSideUnknown;
  uint trackingSteps_ = 0;
};

}  // namespace palpate::cu
