#ifndef PALPATE_SHARED_CONTACT_H
#define PALPATE_SHARED_CONTACT_H
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// One workgroup answers one probe.
const uint kContactWorkgroup = 256;

// The patch: points within (1 + kPatchSlack) support radii of its centre, gathered once and evaluated many times. More
// slack means fewer gathers when the proxy travels, and more points to visit each time.
const float kPatchSlack = 0.5f;
const uint kMaxSharedPatch = 768;  // points kept in shared memory, fewer on small GPUs; the rest spill to a buffer
const uint kPatchRoundCandidates =
    16384;                         // visited for every kContactWorkgroup cells; denser regions are subsampled evenly
const uint kPatchMaxCells = 2048;  // visited by one gather; limits how small cells of a SpatialHash may be
const uint kMaxPatchPoints = kPatchMaxCells / kContactWorkgroup * kPatchRoundCandidates;

// A large first patch is gathered by several workgroups. This pays off once the time saved exceeds the cost of their
// finishing one after the other.
const uint kSplitWorkgroups = 8;
const uint kSplitNeighbours = 1024;  // minimum neighbours at the last answer for a split gather
const uint kSplitCells = 257;        // minimum cells of a gather to split it, whatever they contain

const uint kMinNeighbours = 3;   // fewer points within the support radius do not define a surface
const float kMinNormal = 1e-4f;  // a weighted mean normal shorter than this does not define a face, so no surface

// How the points define a surface around a position: SurfaceKind of engine/contact/surface_kind.hpp.
const uint kSurfaceAverage = 0;
const uint kSurfaceSphere = 1;
const uint kSurfaceSharp = 2;
// Maximum lateral offset of the neighbours' mean from a position, in support radii. It is 0.21 at a straight border,
// and above this everywhere half a radius past the last points. Less cuts into rough sampling, more lets borders grow.
const float kFurthestAside = 0.5f;
const float kMinSpread = 1e-4f;          // of R^2: neighbours closer together than this show no curvature
const float kStrongestCurvature = 1.0f;  // times R: spheres smaller than the support radius are treated as noise
// Robust weights (Oztireli, Guennebaud, Gross 2009): tolerance for a neighbour's normal, as the length of the
// difference, and for the distance of its plane, in support radii. Less keeps sharper edges and uses fewer points.
const uint kSharpPasses = 3;
const float kSharpNormal = 0.5f;
const float kSharpHeight = 0.5f;

// The local support radius: kSupportSpacings local spacings, at most the given radius and at least kMinLocalRadius
// times it.
const float kSupportSpacings = 4.0f;
const float kMinLocalRadius = 0.125f;
// A widened support radius averages noise out where the surface is flat, and shrinks back where it bends: 1 minus the
// mean normal's length at the start and the end of shrinking. It is 0.0694 (R / rho)^2 on a sphere of radius rho, 0.29
// on an edge of 90 degrees. Less also shrinks at noise, more rounds edges off and loses folds.
const float kFlatTurn = 0.01f;
const float kFoldTurn = 0.06f;
// The sharp surface keeps points across an edge out by its weights. For it the radius shrinks where the surface on this
// side of the edge bends: the cosine between a point's normal and the felt face from which on the point counts, and
// from which on it counts in full. More is blind to folds, less rounds off the edges of noisy normals.
const float kAcrossEdge = 0.3f;
const float kThisFace = 0.5f;

// Tangent-plane tracking (Salisbury and Tarr 1997).
const uint kMaxTrackingSteps = 32;
const float kConvergence = 1e-5f;  // of the support radius: maximum step of a converged proxy
// In support radii: a step smaller than this is the last. Each step is at most a quarter of the one before, so a
// smaller value costs another evaluation, and a larger one is felt as a ripple.
const float kLastStep = 1e-4f;
const float kLongestStep = 0.5f;  // of the support radius: for the proxy and for the sub-steps of the HIP
// The normal at the proxy turns in a tick by at most a radian for this much motion of the hand, in support radii, and
// kRestingTurn while it rests. A smaller way lets a deep proxy run around ridges and thin parts, a longer one makes it
// lag on edges.
const float kTurnWay = 0.25f;
const float kRestingTurn = 0.005f;
const float kShortestReturn = 5e-4f;  // of the support radius: to where the normal had not turned too far
const float kStaticFriction = 1.25f;  // times the coefficient of sliding, before a held proxy slides
const uint kMaxSubsteps = 16;  // a HIP that jumps further than these reach may pass through a thin sheet undetected

// Loop iterations of one invocation, far below the 65,535 after which one software driver stops a shader silently.
const uint kContactWorkBudget = 40000;

// Side of the surface on which the HIP was last.
const uint kFaceUnknown = 0;  // nothing in reach
const uint kFaceOutside = 1;
const uint kFaceInside = 2;  // behind a surface, but not reached through free space: not caught on its way out
const uint kFaceBehind = 3;  // behind a sheet, reached through free space: caught where it comes to the front

// State of the proxy in the last tick.
const uint kFree = 0;
const uint kSliding = 1;
const uint kSticking = 2;  // touching, and held by friction

struct ContactPose {
  vec3 hip;  // model units relative to the cloud's origin
  uint tick;
};
PALPATE_SIZE(ContactPose, 16);

// State that one tick passes to the next, on the GPU.
struct ContactState {
  vec3 lastHip;   // model units relative to the cloud's origin
  uint touching;  // kFree, kSliding or kSticking
  vec3 spring;    // from HIP to proxy
  uint face;      // kFace...; while touching, the felt one
  vec3 motion;    // displacement of the HIP since the tick before
  vec3 facing;    // normal of the surface felt last, with the points' sign; zero if there was none
  vec3 velocity;  // of that surface, model units per second
  uint started;   // 0 before the first tick
};
PALPATE_SIZE(ContactState, 72);

const uint kSampleTruncated = 1;   // the work budget was used up before the proxy converged
const uint kSampleThinned = 2;     // more points were near than a step visits: neighbours were subsampled
const uint kSampleFaceShift = 30;  // from this bit on: kFace... of the HIP

// Written by the host before a tick. `carried`: the state to which the host has continued alone, used instead of the
// GPU's if it is started. `pointsAge`: age of moving points, which are extrapolated by it; `sinceLast`: how long the
// surface has moved since the last tick. Both are 0 if points do not move.
struct ContactQuestion {
  ContactPose pose;
  ContactState carried;
  float pointsAge;  // s
  float sinceLast;  // s
  uint withdrawn;   // not 0: a step that waits for its question must end without an answer
  uint seal;        // the sum of questionShare() of all preceding words
};
PALPATE_SIZE(ContactQuestion, 104);

// Before the questions: for a step that was submitted ahead of them and polls for them.
struct QuestionHead {
  uint lastTick;   // of the questions that were there before
  uint polls;      // at most, of each subgroup
  uint rehearses;  // not 0: a step of one probe repeats its last one before it waits
  uint unused1;
};
PALPATE_SIZE(QuestionHead, 16);
const uint kQuestionHeadWords = 4;
const uint kQuestionWords = 26;
const uint kQuestionTickAt = 3, kQuestionWithdrawnAt = 24, kQuestionSealAt = 25;  // words

// Contribution of one word to the seal, which tells a complete question from one whose words are still in flight: in
// any order, by many invocations at once. The finaliser of MurmurHash3 (Appleby 2011).
PALPATE_FUNCTION uint questionShare(uint word, uint place) {
  uint x = word ^ (place + 1u) * 0x9e3779b9u;
  x = (x ^ x >> 16) * 0x85ebca6bu;
  x = (x ^ x >> 13) * 0xc2b2ae35u;
  return x ^ x >> 16;
}

// Read by the host after a tick.
struct ContactSample {
  vec3 spring;    // from HIP to proxy, model units; zero when free
  uint touching;  // kFree, kSliding or kSticking
  vec3 normal;    // unit, outward, at the proxy (at the HIP when free); zero without a surface
  uint neighbours;
  uint tick;
  uint trackingSteps;
  uint logHead;   // entries of the edit log that were complete before this tick
  uint flags;     // kSample...
  vec3 velocity;  // of the surface there, model units per second; zero if points do not move
  uint seal;      // sealOf() the rest
};
PALPATE_SIZE(ContactSample, 64);

const uint kSampleWords = 16;

// Before the samples: where the time of a step that waited for its question went, in ticks of the GPU's own clock. All
// 0 on devices whose shaders cannot read a clock. In the sample's alignment.
struct StepTicks {
  uint waited;    // from the beginning of the step until its question was there
  uint answered;  // from then until the answer was written
  uint unused[14];
};
PALPATE_SIZE(StepTicks, 64);

// Tells a complete sample from one whose words are still in flight to the host, since they may arrive in any order. A
// step of FNV-1a (Fowler, Noll, Vo 1991) for each word.
PALPATE_FUNCTION uint sealedWith(uint seal, uint word) { return (seal ^ word) * 16777619u; }
PALPATE_FUNCTION uint sealedWith(uint seal, vec3 v) {
  seal = sealedWith(seal, floatBitsToUint(v.x));
  seal = sealedWith(seal, floatBitsToUint(v.y));
  return sealedWith(seal, floatBitsToUint(v.z));
}
PALPATE_FUNCTION uint sealOf(ContactSample s) {
  uint seal = sealedWith(sealedWith(sealedWith(2166136261u, s.spring), s.normal), s.touching);
  seal = sealedWith(seal, s.velocity);
  seal = sealedWith(sealedWith(sealedWith(seal, s.neighbours), s.tick), s.trackingSteps);
  return sealedWith(sealedWith(seal, s.logHead), s.flags);
}

// How the first patch of a step is gathered. Later ones, where the proxy leaves it, are gathered by the step itself.
const uint kGatherAlone = 0;  // by the step's single workgroup
const uint kGatherSplit = 1;  // by all its workgroups; the one that finishes last continues alone
const uint kGatherGiven = 2;  // by passes before it

struct ContactStepArgs {
  CloudView cloud;
  PALPATE_ADDRESS(ContactPoses) pose;
  PALPATE_ADDRESS(ContactStates) state;
  PALPATE_ADDRESS(ContactSamples) result;
  PALPATE_ADDRESS(SpilledPoints) spill;  // 2 per point: position relative to the patch's centre, normal
  PALPATE_ADDRESS(Uints) logHead;
  PALPATE_ADDRESS(GatheredPatch) gathered;  // of the first gather, unless it is kGatherAlone
  PALPATE_ADDRESS(Vec4s) velocities;        // if points move: as in shaders/shared/motion.h
  float radius;                             // support radius, model units
  uint gather;                              // kGather...
  uint mostCells;                           // of one gather, limited by its buffers
  uint spillSlots;                          // for each probe of a tool with several
};
PALPATE_SIZE(ContactStepArgs, 128);

// Before a step of several workgroups that was submitted ahead of its questions.
struct AwaitQuestionArgs {
  PALPATE_ADDRESS(QuestionWords) question;  // as the host writes it, one for each probe
  PALPATE_ADDRESS(Uints) taken;             // copy, once all have arrived; tick 0: they have not, or were withdrawn
  uint probes;
  uint unused;
};
PALPATE_SIZE(AwaitQuestionArgs, 24);

PALPATE_SHARED_END
#endif
