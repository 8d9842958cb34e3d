// Fuses a depth frame into a map of surfels, after Keller, Lefloch, Lambers, Izadi, Weyrich and Kolb 2013 ("Real-time
// 3D reconstruction in dynamic scenes using point-based fusion"), with these differences. Each point of the map looks
// up its pixel, not each pixel its point: a point has at most one pixel, no pass has to determine the nearest point,
// and no sum depends on an order. A point moves along the ray on which it is seen, so that points keep their distances.
// And the position of a point in its pixel is recorded in 16 parts of it, so that no new point is created close to it.
// The loops over points and pixels are in engine/motion/surfel_map.cpp and shaders/motion.
#ifndef PALPATE_SHARED_FUSION_H
#define PALPATE_SHARED_FUSION_H
#include "shaders/shared/depth_image.h"
#include "shaders/shared/motion.h"
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// In standard deviations of the noise: a point this near to the plane of its pixel belongs to the same surface.
const float kGateDeviations = 4.0f;
// In the same unit: a point this far in front of all depths around its pixel is in space that the camera sees through.
const float kFreeDeviations = 5.0f;
// Minimum cosine between the normals of a point and its pixel.
const float kSameNormal = 0.5f;
// Minimum cosine, of either sign, between a point's normal and the ray that sees through it: at the rim of a body a
// slightly wrong pose looks past the body.
const float kMinFreeFacing = 0.1f;
// A point measured this many times is stable.
const uint kStableCount = 4u;
// Doubts about a point grow by these in each frame, are cleared when it is measured, and remove it at kMaxDoubts: a
// stable point after it is seen through in 4 frames, an unstable one after 2, or after 30 frames in which it is not
// found.
const uint kMaxDoubts = 60u;
const uint kDoubtsStableFree = 15u;
const uint kDoubtsUnstableFree = 30u;
const uint kDoubtsUnstable = 2u;
// Parts of a pixel along a side.
const uint kPartsOfPixel = 4u;
// Minimum share of a new colour: 8 bits could not represent a smaller change.
const float kMinColorShare = 0.125f;
// RGBA8 of a point whose colour was never seen.
const uint kUnseenColor = 0xffb0b0b0u;

// How a frame sees a point of the map.
const uint kSightNone = 0u;     // not at all: it is out of view, or no depth was measured there
const uint kSightMatched = 1u;  // it was measured
const uint kSightHidden = 2u;   // it is behind the surface seen
const uint kSightFree = 3u;     // the camera sees through it
const uint kSightUnclear = 4u;  // it should be visible, but something else is seen

// One frame, and the rules by which it is fused.
struct FusionView {
  vec3 right;  // axes of the camera in the map, unit
  vec3 down;
  vec3 ahead;
  vec3 centre;  // of the camera, in the map, m
  DepthSensor sensor;
  float memory;  // maximum measurements that a point remembers
  uint width;    // pixels
  uint height;
  uint number;   // of the frame
  uint colored;  // not 0: it has colours
  // If the map is felt (`felt` not 0): points still had `left` seconds of their motion ahead when the frame arrived,
  // and reach the frame's positions within 1 / `perSecond` s.
  uint felt;
  float left;
  float perSecond;
};
PALPATE_SIZE(FusionView, 108);

// Data of a point besides position and normal, by its id.
struct SurfelRecord {
  float weight;  // sum of the measurements' weights, 1 / m^2
  uint seen;     // number of the last frame that measured it
  uint counts;   // measurements in the low 16 bits, doubts above
  uint color;    // RGBA8; alpha 0: none was seen
};
PALPATE_SIZE(SurfelRecord, 16);

PALPATE_FUNCTION uint measurementsOf(SurfelRecord record) { return record.counts & 0xffffu; }
PALPATE_FUNCTION uint doubtsOf(SurfelRecord record) { return record.counts >> 16; }
PALPATE_FUNCTION bool isStable(SurfelRecord record) { return measurementsOf(record) >= kStableCount; }

PALPATE_FUNCTION vec3 directionInCamera(FusionView view, vec3 direction) {
  return vec3(dot(view.right, direction), dot(view.down, direction), dot(view.ahead, direction));
}
PALPATE_FUNCTION vec3 directionInMap(FusionView view, vec3 direction) {
  return direction.x * view.right + direction.y * view.down + direction.z * view.ahead;
}
PALPATE_FUNCTION vec3 placeInCamera(FusionView view, vec3 place) {
  return directionInCamera(view, place - view.centre);
}
PALPATE_FUNCTION vec3 placeInMap(FusionView view, vec3 place) { return view.centre + directionInMap(view, place); }
PALPATE_FUNCTION vec3 placeOfPixel(FusionView view, uvec2 pixel, float depth) {
  return depth * rayThrough(view.sensor.camera, vec2(float(pixel.x), float(pixel.y)));
}

// Projection of a point of the map into the frame.
struct Projection {
  bool inView;
  uvec2 pixel;
  uint part;   // bit of its part of the pixel
  vec3 place;  // in the camera's coordinates
};

PALPATE_FUNCTION Projection projectionOf(FusionView view, vec3 placeInTheMap) {
  Projection projection;
  projection.inView = false;
  projection.pixel = uvec2(0u, 0u);
  projection.part = 0u;
  projection.place = placeInCamera(view, placeInTheMap);
  const vec3 p = projection.place;
  if (!(p.z > 0.0f)) return projection;
  // From the corner of the first pixel, not from its middle.
  const float column = view.sensor.camera.fx * p.x / p.z + view.sensor.camera.cx + 0.5f;
  const float row = view.sensor.camera.fy * p.y / p.z + view.sensor.camera.cy + 0.5f;
  if (!(column >= 0.0f && row >= 0.0f && column < float(view.width) && row < float(view.height))) return projection;
  projection.inView = true;
  projection.pixel = uvec2(uint(column), uint(row));
  const uint x = min(uint((column - float(projection.pixel.x)) * float(kPartsOfPixel)), kPartsOfPixel - 1u);
  const uint y = min(uint((row - float(projection.pixel.y)) * float(kPartsOfPixel)), kPartsOfPixel - 1u);
  projection.part = 1u << (y * kPartsOfPixel + x);
  return projection;
}

// Measurement of a pixel.
struct Measurement {
  uvec2 pixel;
  float depth;           // m; 0: none
  uint color;            // RGBA8, if the frame has colours
  PixelSurface surface;  // fitted there
};

// How a pixel sees a point that projects to it, before the depths around it are checked.
struct Sight {
  uint kind;    // kSight...; kSightFree is provisional: the depths around have to confirm it
  bool covers;  // no new point is needed there
};

// `normal`: of the point, in the camera's coordinates.
PALPATE_FUNCTION Sight sightOf(FusionView view, Projection projection, vec3 normal, Measurement measured) {
  Sight sight;
  sight.kind = kSightNone;
  sight.covers = false;
  const float depth = measured.depth;
  if (!(depth > 0.0f)) return sight;
  const vec3 p = projection.place;
  const float deviation = depthDeviation(view.sensor.noise, depth);
  if (measured.surface.depth > 0.0f) {
    const vec3 offset = p - placeOfPixel(view, measured.pixel, measured.surface.depth);
    if (abs(dot(measured.surface.normal, offset)) <= kGateDeviations * deviation) {
      sight.covers = dot(normal, p) < 0.0f;
      sight.kind = dot(measured.surface.normal, normal) >= kSameNormal ? kSightMatched : kSightUnclear;
      return sight;
    }
  }
  if (p.z > depth + kGateDeviations * deviation) {
    sight.kind = kSightHidden;
    return sight;
  }
  const bool edgeOn = abs(dot(normal, p)) < kMinFreeFacing * length(p);
  sight.kind = p.z < depth - kFreeDeviations * deviation && !edgeOn ? kSightFree : kSightUnclear;
  return sight;
}

// Whether a depth next to the point's pixel is consistent with the camera seeing through the point; a missing depth is.
PALPATE_FUNCTION bool seesThrough(FusionView view, float placeDepth, float depth) {
  return !(depth > 0.0f) || placeDepth < depth - kFreeDeviations * depthDeviation(view.sensor.noise, depth);
}

PALPATE_FUNCTION float measurementWeight(FusionView view, float depth) {
  const float deviation = depthDeviation(view.sensor.noise, depth);
  return 1.0f / (deviation * deviation);
}

// The weight after one more measurement, limited to `memory` measurements like this one, so that a map follows changes;
// a weight from nearer by is not reduced by measurements from afar.
PALPATE_FUNCTION float weightAfter(float before, float measurement, float memory) {
  return max(before, min(before + measurement, memory * measurement));
}

PALPATE_FUNCTION uint mixedColor(uint before, uint measured, float share) {
  if (before >> 24 == 0u) return measured;
  const int part = int(max(share, kMinColorShare) * 256.0f + 0.5f);
  uint mixed = 0xff000000u;
  for (uint shift = 0u; shift < 24u; shift += 8u) {
    const int old = int(before >> shift & 0xffu);
    const int now = int(measured >> shift & 0xffu);
    const int step = ((now - old) * part + 128) >> 8;
    mixed |= uint(old + step) << shift;
  }
  return mixed;
}

// A point of the map while a frame is fused.
struct Surfel {
  vec3 place;   // in the map
  vec3 normal;  // unit
  SurfelRecord record;
};

// Motion of a point to the pose that a frame gives it.
struct SurfelWay {
  vec3 velocity;  // m/s
  vec3 turn;      // rate of its normal, 1/s
};

// Motion of a point with a present position, normal and motion. A point whose normal rotates by 90 degrees or more does
// not move: it is at its new pose at once.
PALPATE_FUNCTION SurfelWay wayOn(FusionView view, vec3 place, vec3 normal, SurfelWay way, vec3 toPlace, vec3 toNormal) {
  const vec3 from = normalAfter(normal, way.turn, -view.left);
  SurfelWay on;
  on.velocity = vec3(0.0f, 0.0f, 0.0f);
  on.turn = vec3(0.0f, 0.0f, 0.0f);
  if (!(dot(from, toNormal) > 0.0f)) return on;
  on.velocity = view.perSecond * (toPlace - place + view.left * way.velocity);
  on.turn = view.perSecond * (toNormal - from);
  return on;
}

// The weighted average of a point and the measurement of its pixel. The point moves along the ray from the camera,
// towards the plane through the measured position: depth noise, which has displaced it along this ray, is undone along
// the same ray, and not towards its neighbours.
PALPATE_FUNCTION Surfel averaged(FusionView view, Surfel before, Measurement measured) {
  Surfel after = before;
  const float weight = measurementWeight(view, measured.depth);
  const float share = weight / (before.record.weight + weight);
  after.normal = normalize((1.0f - share) * before.normal + share * directionInMap(view, measured.surface.normal));
  const vec3 ray = normalize(before.place - view.centre);
  const float facing = min(dot(after.normal, ray), -kMinFacing);
  const vec3 offset = placeInMap(view, placeOfPixel(view, measured.pixel, measured.depth)) - before.place;
  after.place = before.place + share * dot(after.normal, offset) / facing * ray;
  after.record.weight = weightAfter(before.record.weight, weight, view.memory);
  after.record.seen = view.number;
  after.record.counts = min(measurementsOf(before.record) + 1u, 0xffffu);
  if (view.colored != 0u) after.record.color = mixedColor(before.record.color, measured.color, share);
  return after;
}

// A new point at the measurement of a pixel.
PALPATE_FUNCTION Surfel bornAt(FusionView view, Measurement measured) {
  Surfel surfel;
  surfel.place = placeInMap(view, placeOfPixel(view, measured.pixel, measured.depth));
  surfel.normal = directionInMap(view, measured.surface.normal);
  surfel.record.weight = measurementWeight(view, measured.depth);
  surfel.record.seen = view.number;
  surfel.record.counts = 1u;
  surfel.record.color = view.colored != 0u ? measured.color : 0u;
  return surfel;
}

// A record after a frame in which its point was not measured; unchanged if that is not evidence against the point.
PALPATE_FUNCTION SurfelRecord doubted(SurfelRecord record, uint sight) {
  uint doubts = 0u;
  if (sight == kSightFree) doubts = isStable(record) ? kDoubtsStableFree : kDoubtsUnstableFree;
  if (!isStable(record) && (sight == kSightHidden || sight == kSightUnclear)) doubts = kDoubtsUnstable;
  record.counts += doubts << 16;
  return record;
}
PALPATE_FUNCTION bool isGivenUp(SurfelRecord record) { return doubtsOf(record) >= kMaxDoubts; }

// Parts of a pixel, and of the pixels beside it, in which a point of the map is close to the pixel's middle: within the
// pixel, or at most a quarter of a pixel beside it. If there is one, no new point is created.
const uint kPartsWithin = 0xffffu;
const uint kPartsLeft = 0x8888u;  // of the pixel to the left
const uint kPartsRight = 0x1111u;
const uint kPartsAbove = 0xf000u;
const uint kPartsBelow = 0x000fu;

// Whether points are close to a pixel's middle, by the parts of it and of the pixels beside it.
PALPATE_FUNCTION bool isCovered(uint within, uint left, uint right, uint above, uint below) {
  return (within & kPartsWithin) != 0u || (left & kPartsLeft) != 0u || (right & kPartsRight) != 0u ||
         (above & kPartsAbove) != 0u || (below & kPartsBelow) != 0u;
}

PALPATE_SHARED_END
#endif
