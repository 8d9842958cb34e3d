// The proxy from tick to tick: contact begins where the HIP's motion crosses the surface, and the proxy tracks the
// tangent plane (Salisbury and Tarr 1997), held or dragged by friction (Ruspini, Kolarov, Khatib 1997). All places are
// relative to the HIP. Who walks: shaders/contact/contact_step.comp, engine/contact/proxy_tracker.cpp in double
// precision, engine/cuda/contact_step.cuh.
#ifndef PALPATE_SHARED_PROXY_H
#define PALPATE_SHARED_PROXY_H
#include "shaders/shared/contact.h"

PALPATE_SHARED_BEGIN

// Free: whether a HIP at this face (kFace...) crosses the surface with its next sub-step, after which it is in front of
// the surface or not.
PALPATE_FUNCTION bool crosses(uint face, bool inFront) { return inFront ? face == kFaceBehind : face == kFaceOutside; }

// Sub-steps of a free HIP that has come so far since the last tick, in kLongestStep support radii.
PALPATE_FORMULA uint substepsOn(Real way) { return clamp(uint(ceil(min(way, Real(kMaxSubsteps)))), 1u, kMaxSubsteps); }

// The face at which a HIP is that has not crossed a surface. `defined`: there is one in reach, or where it `ends`;
// `traced`: the sub-steps cover the way since the last tick. Who was lost within a body stays so until it is out, and
// who is past the rim of a sheet is out.
PALPATE_FUNCTION uint faceAfter(uint face, bool defined, bool ends, bool inFront, bool traced) {
  if (!defined) return face == kFaceInside && !ends ? face : kFaceUnknown;
  if (inFront) return kFaceOutside;
  if (face != kFaceUnknown) return face;
  return traced ? kFaceBehind : kFaceInside;
}

// No longer than `longest`.
PALPATE_FORMULA PALPATE_VEC3 shortened(PALPATE_VEC3 step, Real longest) {
  const Real size = length(step);
  return size > longest ? step * (longest / size) : step;
}

// The part of a slide that friction leaves: the proxy is held while the force stays in the cone, and dragged along its
// border once it has left it. `depth`: of the HIP below the surface; `friction`: coefficient while the proxy slides;
// `sticking`: it has not slid in the last tick.
PALPATE_FORMULA PALPATE_VEC3 againstFriction(PALPATE_VEC3 slide, Real depth, Real friction, bool sticking) {
  const Real size = length(slide);
  const Real held = friction * max(Real(0.0), depth);
  if (size <= (sticking ? Real(kStaticFriction) * held : held)) return PALPATE_VEC3(Real(0.0));
  return slide * (Real(1.0) - held / size);
}

// From the proxy to where the HIP is nearest in the tangent plane, as far as friction lets it.
PALPATE_FORMULA PALPATE_VEC3 slideAlong(PALPATE_VEC3 normal, PALPATE_VEC3 proxy, Real friction, bool sticking) {
  const Real depth = dot(proxy, normal);
  return againstFriction(depth * normal - proxy, depth, friction, sticking);
}

// What the steps of one tick leave to one another.
PALPATE_STRUCT(Tracking) {
  PALPATE_VEC3 lastSlide;
  Real relaxation;
  bool sticking;
  bool slid;  // in this tick
};

// The proxy goes `firstSlide` at once where it is not less than `arrived`, without evaluating the surface there.
PALPATE_FORMULA PALPATE_OF(Tracking) trackingFrom(PALPATE_VEC3 firstSlide, bool sticking, Real arrived) {
  PALPATE_OF(Tracking) tracking;
  tracking.lastSlide = firstSlide;
  tracking.relaxation = Real(1.0);
  tracking.slid = length(firstSlide) >= arrived;
  tracking.sticking = sticking && !tracking.slid;
  return tracking;
}

// The step that a proxy wants to take.
PALPATE_STRUCT(TrackingStep) {
  PALPATE_VEC3 lift;  // onto the surface
  PALPATE_VEC3 slide;
  Real size;
};

// `normal` and `distance`: of the surface at the proxy, its outside the face that is felt.
PALPATE_FORMULA PALPATE_OF(TrackingStep)
    nextStep(PALPATE_OF(Tracking) tracking, PALPATE_VEC3 proxy, PALPATE_VEC3 normal, Real distance, Real friction) {
  PALPATE_OF(TrackingStep) step;
  step.lift = -distance * normal;
  step.slide = slideAlong(normal, proxy, friction, tracking.sticking);
  step.size = max(length(step.lift), tracking.relaxation * length(step.slide));
  return step;
}

// Takes the step; how the proxy moves.
PALPATE_FORMULA PALPATE_VEC3 takeStep(PALPATE_INOUT(PALPATE_OF(Tracking)) tracking, PALPATE_OF(TrackingStep) step,
                                      Real longest) {
  // A slide that turns back has overshot, as it does in a hollow narrower than the HIP is deep.
  if (dot(step.slide, tracking.lastSlide) < Real(0.0)) tracking.relaxation *= Real(0.5);
  tracking.lastSlide = step.slide;
  if (step.slide != PALPATE_VEC3(Real(0.0))) {
    tracking.slid = true;
    tracking.sticking = false;
  }
  return shortened(step.lift, longest) + shortened(tracking.relaxation * step.slide, longest);
}

PALPATE_SHARED_END
#endif
