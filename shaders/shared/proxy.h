// The proxy from tick to tick: contact begins where the HIP's motion crosses the surface, and the proxy tracks the
// tangent plane (Salisbury and Tarr 1997), held or dragged by friction (Ruspini, Kolarov, Khatib 1997). All positions
// are relative to the HIP, or, with the HIP, to the cloud's origin. shaders/contact/contact_step.comp,
// engine/contact/proxy_tracker.cpp (double precision) and engine/cuda/contact_step.cuh evaluate the surface wherever a
// tick asks for it.
#ifndef PALPATE_SHARED_PROXY_H
#define PALPATE_SHARED_PROXY_H
#include "shaders/shared/contact.h"
#include "shaders/shared/surface.h"

PALPATE_SHARED_BEGIN

// Whether a free HIP crosses the surface in its next sub-step. `face`: its kFace... before it; `inFront`: whether it is
// in front of the surface afterwards.
PALPATE_FUNCTION bool crosses(uint face, bool inFront) { return inFront ? face == kFaceBehind : face == kFaceOutside; }

// Sub-steps of a free HIP for its displacement since the last tick, `way`, in units of kLongestStep support radii.
PALPATE_FORMULA uint substepsOn(Real way) { return clamp(uint(ceil(min(way, Real(kMaxSubsteps)))), 1u, kMaxSubsteps); }

// The face of a HIP that has not crossed a surface. `defined`: a surface is in reach; `ends`: the HIP is past the rim
// of a sheet; `traced`: the sub-steps cover the path since the last tick. A HIP lost inside a body stays inside until
// it is out; a HIP past the rim of a sheet is out.
PALPATE_FUNCTION uint faceAfter(uint face, bool defined, bool ends, bool inFront, bool traced) {
  if (!defined) return face == kFaceInside && !ends ? face : kFaceUnknown;
  if (inFront) return kFaceOutside;
  if (face != kFaceUnknown) return face;
  return traced ? kFaceBehind : kFaceInside;
}

// Limited to the length `longest`.
PALPATE_FORMULA PALPATE_VEC3 shortened(PALPATE_VEC3 step, Real longest) {
  const Real size = length(step);
  return size > longest ? step * (longest / size) : step;
}

// The part of a slide that friction leaves: the proxy is held while the force is inside the friction cone, and dragged
// along the cone's border outside it. `depth`: of the HIP below the surface; `friction`: coefficient while the proxy
// slides; `sticking`: the proxy did not slide in the last tick.
PALPATE_FORMULA PALPATE_VEC3 againstFriction(PALPATE_VEC3 slide, Real depth, Real friction, bool sticking) {
  const Real size = length(slide);
  const Real held = friction * max(Real(0.0), depth);
  if (size <= (sticking ? Real(kStaticFriction) * held : held)) return PALPATE_VEC3(Real(0.0));
  return slide * (Real(1.0) - held / size);
}

// From the proxy to the point of the tangent plane nearest to the HIP, as far as friction allows.
PALPATE_FORMULA PALPATE_VEC3 slideAlong(PALPATE_VEC3 normal, PALPATE_VEC3 proxy, Real friction, bool sticking) {
  const Real depth = dot(proxy, normal);
  return againstFriction(depth * normal - proxy, depth, friction, sticking);
}

// State that the steps of one tick pass on to each other.
PALPATE_STRUCT(Tracking) {
  PALPATE_VEC3 lastSlide;
  Real relaxation;
  bool sticking;
  bool slid;  // in this tick
};

// The proxy takes `firstSlide` at once, without an evaluation of the surface, if the slide is at least `arrived` long.
PALPATE_FORMULA PALPATE_OF(Tracking) trackingFrom(PALPATE_VEC3 firstSlide, bool sticking, Real arrived) {
  PALPATE_OF(Tracking) tracking;
  tracking.lastSlide = firstSlide;
  tracking.relaxation = Real(1.0);
  tracking.slid = length(firstSlide) >= arrived;
  tracking.sticking = sticking && !tracking.slid;
  return tracking;
}

// The step that a proxy is to take.
PALPATE_STRUCT(TrackingStep) {
  PALPATE_VEC3 lift;  // onto the surface
  PALPATE_VEC3 slide;
  Real size;
};

// `normal` and `distance`: of the surface at the proxy; its outside is the felt face.
PALPATE_FORMULA PALPATE_OF(TrackingStep)
    nextStep(PALPATE_OF(Tracking) tracking, PALPATE_VEC3 proxy, PALPATE_VEC3 normal, Real distance, Real friction) {
  PALPATE_OF(TrackingStep) step;
  step.lift = -distance * normal;
  step.slide = slideAlong(normal, proxy, friction, tracking.sticking);
  step.size = max(length(step.lift), tracking.relaxation * length(step.slide));
  return step;
}

// Takes the step; returns the displacement of the proxy.
PALPATE_FORMULA PALPATE_VEC3 takeStep(PALPATE_INOUT(PALPATE_OF(Tracking)) tracking, PALPATE_OF(TrackingStep) step,
                                      Real longest) {
  // A slide that reverses has overshot, as it does in a hollow narrower than the HIP is deep.
  if (dot(step.slide, tracking.lastSlide) < Real(0.0)) tracking.relaxation *= Real(0.5);
  tracking.lastSlide = step.slide;
  if (step.slide != PALPATE_VEC3(Real(0.0))) {
    tracking.slid = true;
    tracking.sticking = false;
  }
  return shortened(step.lift, longest) + shortened(tracking.relaxation * step.slide, longest);
}

// What a tick evaluates the surface for.
const uint kWalks = 0;   // free, along the HIP's motion, until it crosses the surface
const uint kTracks = 1;  // touching, from tangent plane to tangent plane
const uint kLeaves = 2;  // no longer touching, at the HIP

// The proxy in the course of a tick.
PALPATE_STRUCT(ProxyTick) {
  PALPATE_VEC3 at;      // where the surface is evaluated; while the proxy walks, the caller's place of this sub-step
  PALPATE_VEC3 before;  // the place of the last sub-step
  PALPATE_VEC3 proxy;
  PALPATE_OF(Tracking) tracking;
  PALPATE_VEC3 felt;  // normal of the felt face where the proxy was; zero if it is unknown
  PALPATE_VEC3 kept;  // the last place at which the normal had not turned too far
  Real leastCosine;   // between that normal and one that has turned as far as it may
  bool keeps;         // there was such a place in this tick
  bool turnsTooFar;   // the proxy is on its way back to `kept`, or there
  uint purpose;
  uint substep;  // from 1 on
  uint trackingSteps;
  uint face;  // kFace...; while touching, the face that is felt
  bool touching;
  bool sticking;   // the proxy did not slide in the last tick
  bool truncated;  // not converged when the work budget was spent
};

// Begins a tick. `touching`, `sticking`, `face`, `proxy`: as the last tick left them; `facing`: normal of the surface
// felt then, or zero. A hand in contact has felt the surface at the proxy: its first slide follows that surface,
// without another evaluation.
PALPATE_FORMULA PALPATE_OF(ProxyTick)
    tickFrom(bool touching, bool sticking, uint face, PALPATE_VEC3 facing, PALPATE_VEC3 lastHip, PALPATE_VEC3 proxy,
             PALPATE_VEC3 hip, Real radius, Real friction) {
  PALPATE_VEC3 slide = PALPATE_VEC3(Real(0.0));
  PALPATE_OF(ProxyTick) tick;
  tick.felt = face == kFaceBehind ? -facing : facing;
  if (touching && facing != PALPATE_VEC3(Real(0.0))) slide = slideAlong(tick.felt, proxy - hip, friction, sticking);
  tick.kept = proxy;
  const Real turn = Real(kRestingTurn) + distance(lastHip, hip) / (Real(kTurnWay) * radius);
  tick.leastCosine = cos(min(turn, Real(3.0)));
  tick.keeps = false;
  tick.turnsTooFar = false;
  tick.tracking = trackingFrom(slide, sticking, Real(kConvergence) * radius);
  tick.proxy = tick.tracking.slid ? proxy + shortened(slide, Real(kLongestStep) * radius) : proxy;
  tick.at = tick.proxy;
  tick.before = lastHip;
  tick.purpose = touching ? kTracks : kWalks;
  tick.substep = 1;
  tick.trackingSteps = 0;
  tick.face = face;
  tick.touching = touching;
  tick.sticking = sticking;
  tick.truncated = false;
  return tick;
}

// Touching: takes the step that the surface at the proxy requires. False if the proxy rests. Where the hand is deeper
// than the radius of a ridge or of a thin part's rim, a proxy without friction would run around it at once, to the side
// from which the hand did not come. So the hand's motion limits how far the normal turns.
PALPATE_FORMULA bool takesStep(PALPATE_INOUT(PALPATE_OF(ProxyTick)) tick, PALPATE_OF(Surface) surface, PALPATE_VEC3 hip,
                               Real radius, Real friction, bool spent) {
  if (tick.trackingSteps == kMaxTrackingSteps || !surface.defined) return false;
  const Real arrived = Real(kConvergence) * radius;
  if (dot(tick.felt, surface.normal) < tick.leastCosine) {
    const PALPATE_VEC3 back = Real(0.5) * (tick.proxy - tick.kept);
    tick.turnsTooFar = length(back) >= Real(kShortestReturn) * radius;
    if (tick.turnsTooFar) {
      tick.proxy -= back;
      ++tick.trackingSteps;
      return !spent;
    }
    if (tick.keeps) {
      tick.turnsTooFar = true;
      return false;
    }
    tick.felt = surface.normal;  // the surface itself has turned
  }
  if (tick.turnsTooFar) {
    tick.proxy -= surface.distance * surface.normal;
    return false;
  }
  tick.kept = tick.proxy;
  tick.keeps = true;
  const PALPATE_OF(TrackingStep) step =
      nextStep(tick.tracking, tick.proxy - hip, surface.normal, surface.distance, friction);
  tick.truncated = step.size >= arrived && spent;
  if (tick.truncated || step.size < arrived) return false;
  tick.proxy += takeStep(tick.tracking, step, Real(kLongestStep) * radius);
  ++tick.trackingSteps;
  return step.size >= Real(kLastStep) * radius;
}

// Continues from the surface at `tick.at`, whose outside is the felt face. False if the tick ends there. `substeps`:
// substepsOn() the path; `traced`: they cover it; `spent`: the work budget is.
PALPATE_FORMULA bool goesOn(PALPATE_INOUT(PALPATE_OF(ProxyTick)) tick, PALPATE_OF(Surface) surface, PALPATE_VEC3 hip,
                            Real radius, Real friction, uint substeps, bool traced, bool spent) {
  if (tick.purpose == kLeaves) return false;
  if (tick.purpose == kWalks) {
    const bool inFront = surface.distance > Real(0.0);
    if (surface.defined && crosses(tick.face, inFront)) {
      tick.purpose = kTracks;
      tick.touching = true;
      tick.sticking = true;
      tick.tracking = trackingFrom(PALPATE_VEC3(Real(0.0)), true, Real(kConvergence) * radius);
      tick.proxy = tick.before;
      tick.felt = tick.face == kFaceBehind ? -surface.normal : surface.normal;
      tick.kept = tick.proxy;
      tick.at = tick.proxy;
      return true;
    }
    tick.face = faceAfter(tick.face, surface.defined, surface.ends, inFront, traced);
    tick.before = tick.at;
    return ++tick.substep <= substeps;
  }
  if (takesStep(tick, surface, hip, radius, friction, spent)) {
    tick.at = tick.proxy;
    return true;
  }
  tick.sticking = !tick.tracking.slid;
  if (surface.defined && dot(tick.proxy - hip, surface.normal) >= Real(0.0)) return false;
  if (tick.turnsTooFar && !spent) {  // the hand has come out past the edge: the proxy follows
    tick.turnsTooFar = false;
    tick.leastCosine = Real(-1.0);
    tick.at = tick.proxy;
    return true;
  }
  if (!surface.defined) tick.face = kFaceInside;  // lost inside: not caught again on the way out
  tick.purpose = kLeaves;
  tick.touching = false;
  tick.proxy = hip;
  tick.at = hip;
  return true;
}

PALPATE_SHARED_END
#endif
