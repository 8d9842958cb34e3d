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
    16384;                         // visited for every kContactWorkgroup cells; denser places are thinned evenly
const uint kPatchMaxCells = 2048;  // visited by one gather; SpatialHash cells must not be smaller than allows
const uint kMaxPatchPoints = kPatchMaxCells / kContactWorkgroup * kPatchRoundCandidates;

// A first patch that is large is gathered by a few workgroups, which pays once they save more than they cost by
// finishing one after the other.
const uint kSplitWorkgroups = 8;
const uint kSplitNeighbours = 1024;  // of the last answer: from here on
const uint kSplitCells = 257;        // that a gather may visit: from here on, whatever they hold

const uint kMinNeighbours = 3;   // fewer points than this within the support radius are no surface
const float kMinNormal = 1e-4f;  // weighted normals that cancel below this (of 1) give no face, so no surface

// What the points define around a place: SurfaceKind of engine/contact/surface_kind.hpp.
const uint kSurfaceAverage = 0;
const uint kSurfaceSphere = 1;
const uint kSurfaceSharp = 2;
// The mean of the neighbours may lie so far aside of a place, in support radii. At a straight border it is 0.21; half a
// radius past the last points everything lies further. Less cuts into rough sampling, more lets borders grow.
const float kFurthestAside = 0.5f;
const float kMinSpread = 1e-4f;          // of R^2: neighbours closer together than this show no curvature
const float kStrongestCurvature = 1.0f;  // times R: spheres smaller than the support radius are taken for noise
// Robust weights (Oztireli, Guennebaud, Gross 2009): how far a neighbour's normal may turn, as the length of the
// difference, and its plane may stand off, in support radii. Less keeps sharper edges and listens to fewer points.
const uint kSharpPasses = 3;
const float kSharpNormal = 0.5f;
const float kSharpHeight = 0.5f;

// The local support radius: so many local spacings, at most the given radius and at least this share of it.
const float kSupportSpacings = 4.0f;
const float kMinLocalRadius = 0.125f;
// A widened support radius averages noise out where the surface is flat, and shrinks back where it turns: by how much
// shorter than 1 the mean normal is from which on it shrinks, and where it is back. (R / rho)^2 times 0.0694 on a
// sphere of radius rho, 0.29 on an edge of 90 degrees. Less is wary of noisy normals, more rounds edges off and loses
// folds.
const float kFlatTurn = 0.01f;
const float kFoldTurn = 0.06f;
// The sharp surface keeps points across an edge out by itself. For it the radius shrinks where the surface on this side
// of the edge turns: points count whose normal and the face that is felt make at least the first cosine, in full from
// the second on. More is blind to folds, less rounds off the edges of noisy normals.
const float kAcrossEdge = 0.3f;
const float kThisFace = 0.5f;

// Tangent-plane tracking (Salisbury and Tarr 1997).
const uint kMaxTrackingSteps = 32;
const float kConvergence = 1e-5f;  // of the support radius: largest step of a proxy that has arrived
// Of the support radius: a step smaller than this is the last. From step to step they shrink to a quarter and less, so
// that a smaller value costs another evaluation, and a larger one is felt as a ripple.
const float kLastStep = 1e-4f;
const float kLongestStep = 0.5f;      // of the support radius: for the proxy and for the sub-steps of the HIP
const float kStaticFriction = 1.25f;  // times the coefficient of sliding, before a held proxy slides
const uint kMaxSubsteps = 16;         // a HIP that jumps further than these reach may pass a thin sheet unseen

// Loop rounds of one invocation, kept far below the 65,535 after which one software driver stops a shader silently.
const uint kContactWorkBudget = 40000;

// Where the HIP was last, as far as the surface can tell.
const uint kFaceUnknown = 0;  // nothing in reach
const uint kFaceOutside = 1;
const uint kFaceInside = 2;  // behind a surface without having come there through free space: not caught on its way out
const uint kFaceBehind = 3;  // behind a sheet, from free space: caught where it comes to the front

// How the proxy was in the last tick.
const uint kFree = 0;
const uint kSliding = 1;
const uint kSticking = 2;  // touching, and friction held it

struct ContactPose {
  vec3 hip;  // model units relative to the cloud's origin
  uint tick;
};
PALPATE_SIZE(ContactPose, 16);

// What one tick leaves to the next, on the GPU.
struct ContactState {
  vec3 lastHip;   // model units relative to the cloud's origin
  uint touching;  // kFree, kSliding or kSticking
  vec3 spring;    // from HIP to proxy
  uint face;      // kFace...; while touching, the one that is felt
  vec3 motion;    // of the HIP since the tick before
  vec3 facing;    // normal of the surface felt last, as the points have it; zero where there was none
  vec3 velocity;  // of that surface, model units per second
  uint started;   // 0 before the first tick
};
PALPATE_SIZE(ContactState, 72);

const uint kSampleTruncated = 1;   // the work budget was spent before the proxy arrived
const uint kSampleThinned = 2;     // more points were near than a step visits; every so-manyth was taken
const uint kSampleFaceShift = 30;  // from this bit on: kFace... of the HIP

// What the host writes before a tick. `carried`: where it has gone on from by itself since the last one, in its place;
// not started: it has not. Where points move, they are so old, and move on from where they were; the surface has moved
// for so long since the last tick. Both 0 where they stand still.
struct ContactQuestion {
  ContactPose pose;
  ContactState carried;
  float pointsAge;  // s
  float sinceLast;  // s
  uint withdrawn;   // not 0: a step that waits for its question shall end without an answer
  uint seal;        // the sum of questionShare() of all words before it
};
PALPATE_SIZE(ContactQuestion, 104);
const uint kQuestionWords = 26;
const uint kQuestionTickAt = 3, kQuestionWithdrawnAt = 24, kQuestionSealAt = 25;  // words

// What one word gives to the seal, by which a question that has arrived whole is told from one whose words are still on
// their way: in any order, by many invocations at once. The finaliser of MurmurHash3 (Appleby 2011).
PALPATE_FUNCTION uint questionShare(uint word, uint place) {
  uint x = word ^ (place + 1u) * 0x9e3779b9u;
  x = (x ^ x >> 16) * 0x85ebca6bu;
  x = (x ^ x >> 13) * 0xc2b2ae35u;
  return x ^ x >> 16;
}

// What the host reads after a tick.
struct ContactSample {
  vec3 spring;    // from HIP to proxy, model units; zero when free
  uint touching;  // kFree, kSliding or kSticking
  vec3 normal;    // unit, outward, at the proxy (at the HIP when free); zero where there is no surface
  uint neighbours;
  uint tick;
  uint trackingSteps;
  uint logHead;   // entries of the edit log complete before this tick
  uint flags;     // kSample...
  vec3 velocity;  // of the surface there, model units per second; zero where points stand still
  uint seal;      // sealOf() the rest
};
PALPATE_SIZE(ContactSample, 64);

// Tells a sample that has arrived whole from one whose words are still on their way to the host: they may come in any
// order. A step of FNV-1a (Fowler, Noll, Vo 1991) for each word.
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

// Who gathers the first patch of a step. Later ones, where the proxy leaves it, the step gathers by itself.
const uint kGatherAlone = 0;  // the step's one workgroup
const uint kGatherSplit = 1;  // all its workgroups; the one that finishes last goes on alone
const uint kGatherGiven = 2;  // passes before it

struct ContactStepArgs {
  CloudView cloud;
  PALPATE_ADDRESS(ContactPoses) pose;
  PALPATE_ADDRESS(ContactStates) state;
  PALPATE_ADDRESS(ContactSamples) result;
  PALPATE_ADDRESS(SpilledPoints) spill;  // 2 per point: place relative to the patch's centre, normal
  PALPATE_ADDRESS(Uints) logHead;
  PALPATE_ADDRESS(GatheredPatch) gathered;  // of the first gather, unless it is kGatherAlone
  PALPATE_ADDRESS(Vec4s) velocities;        // where points move: as shaders/shared/motion.h has them
  float radius;                             // support radius, model units
  uint gather;                              // kGather...
  uint mostCells;                           // of one gather, by the room in its buffers
  uint spillSlots;                          // of each probe of a tool, where there are many
};
PALPATE_SIZE(ContactStepArgs, 128);

// A step that was submitted before its questions were there polls for them so many times at most.
struct AwaitQuestionArgs {
  PALPATE_ADDRESS(QuestionWords) question;  // as the host writes it, one for each probe
  PALPATE_ADDRESS(Uints) taken;             // the same once all have come; tick 0: they have not, or were withdrawn
  PALPATE_ADDRESS(Uints) lastTick;          // of the questions that stood there before
  uint polls;                               // of each subgroup
  uint probes;
};
PALPATE_SIZE(AwaitQuestionArgs, 32);

PALPATE_SHARED_END
#endif
