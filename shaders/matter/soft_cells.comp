#version 460
#extension GL_GOOGLE_include_directive : require
// Forces of the cells of a soft body on their nodes. Of the cells with skin points, those that may touch a wall or a
// ball test their points; forces on these go to the corners with the others, so that no atomics are needed.
#include "shaders/lib/index.glsl"
#include "shaders/shared/soft_passes.h"

layout(push_constant, scalar) uniform Push { SoftCellsArgs args; };

#include "shaders/lib/matter_sums.glsl"
#include "shaders/lib/soft_cells.glsl"

// Whether cells may have a rest shape other than a cube.
layout(constant_id = 1) const bool kSculpted = false;
// Whether the nodes are at the positions of a trial: walls then respond to the displacement of points from their
// present positions, as linear springs.
layout(constant_id = 2) const bool kTries = false;

Corners moved, velocity, forces;

void readNodes(uint slot) {
  const uvec4 corners = args.corners.at[slot];
  [[unroll]] for (uint k = 0; k < 8; ++k) {
    const uint node = nodeAt(corners, k);
    moved.at[k] = args.nodes.at[kNodeVec4s * node].xyz;
    velocity.at[k] = args.nodes.at[kNodeVec4s * node + 1].xyz;
  }
}

// Whether a skin point in the cell may be in a wall or a ball: all are between the corners.
bool mayMeet(uint slot) {
  const float ball = SETTING.ball;
  vec3 low, high;
  boxOf(args.skinCells.at[slot].corner, moved, low, high);
  if (any(lessThan(low, vec3(0))) || any(greaterThan(high, SETTING.box))) return true;
  for (uint tool = 0; tool < args.toolCount; ++tool) {
    const vec3 middle = args.tools.at[tool].place;
    const vec3 away = max(max(low - middle, middle - high), vec3(0));
    if (dot(away, away) < ball * ball) return true;
  }
  return false;
}

struct SkinNow {
  vec3 share;
  vec3 place;
  vec3 velocity;
  SoftTouch touch;
};

SkinNow skinAt(uint slot, uint at) {
  const vec4 share = args.skin.at[kSkinVec4s * at];
  const uvec4 corners = args.corners.at[slot];
  SkinNow now;
  now.share = share.xyz;
  now.touch = SoftTouch(share.w, SETTING.damping * share.w, SETTING.friction);
  vec3 moved = vec3(0);
  now.velocity = vec3(0);
  for (uint k = 0; k < 8; ++k) {
    const uint node = nodeAt(corners, k);
    const float part = cornerShare(now.share, int(k));
    moved += part * args.nodes.at[kNodeVec4s * node].xyz;
    now.velocity += part * args.nodes.at[kNodeVec4s * node + 1].xyz;
  }
  now.place = args.skin.at[kSkinVec4s * at + 1].xyz + moved;
  return now;
}

void handToCorners(vec3 share, vec3 force) {
  [[unroll]] for (int k = 0; k < 8; ++k) forces.at[k] += cornerShare(share, k) * force;
}

// Response of the walls in which a point is at present.
vec3 wallsAnswer(uint slot, uint at, SkinNow now) {
  vec3 place = args.skin.at[kSkinVec4s * at + 1].xyz;
  const uvec4 corners = args.corners.at[slot];
  for (uint k = 0; k < 8; ++k)
    place += cornerShare(now.share, int(k)) * args.present.at[kNodeVec4s * nodeAt(corners, k)].xyz;
  const vec3 depths = depthsInWalls(place, SETTING.box);
  return mix(vec3(0), now.touch.stiffness * (place - now.place), notEqual(depths, vec3(0)));
}

// Returns the impulse on the walls.
vec3 pressOnWalls(uint slot) {
  const vec3 box = SETTING.box;
  vec3 sum = vec3(0);
  for (uint at = args.skinCells.at[slot].first; at < args.skinCells.at[slot + 1].first; ++at) {
    const SkinNow now = skinAt(slot, at);
    const vec3 force =
        kTries ? wallsAnswer(slot, at, now) : wallsForce(now.touch, box, now.place, now.velocity);
    if (force == vec3(0)) continue;
    handToCorners(now.share, force);
    sum -= force;
  }
  return SETTING.step * sum;
}

// The impulses on the ball of a tool.
void pressOnTool(uint slot, uint tool, inout vec3 impulse, inout vec3 angular) {
  const vec3 middle = args.tools.at[tool].place, speed = args.tools.at[tool].velocity, spin = args.tools.at[tool].spin;
  const float radius = SETTING.ball, step = SETTING.step;
  for (uint at = args.skinCells.at[slot].first; at < args.skinCells.at[slot + 1].first; ++at) {
    const SkinNow now = skinAt(slot, at);
    const vec3 offset = now.place - middle;
    const vec3 force = ballForce(now.touch, radius, offset, now.velocity - (speed + cross(spin, offset)));
    if (force == vec3(0)) continue;
    handToCorners(now.share, force);
    impulse -= step * force;
    angular -= step * cross(offset, force);
  }
}

// Writes both rows of the block's sums.
void keepSums(uint row, vec4 a, vec4 b) {
  if (gl_LocalInvocationIndex != 0) return;
  args.sums.at[row * args.blocks + workgroupIndex()] = a;
  args.sums.at[(row + 1) * args.blocks + workgroupIndex()] = b;
}

// All invocations of the workgroup call it together.
void meetTools(uint slot, bool meets) {
  for (uint tool = 0; tool < args.toolCount; ++tool) {
    vec3 impulse = vec3(0), angular = vec3(0);
    if (meets) pressOnTool(slot, tool, impulse, angular);
    vec4 a = vec4(impulse, 0), b = vec4(angular, 0);
    addUp(a, b, false);
    keepSums(kSoftRowsOfAll + 2 * tool, a, b);
  }
}

CellRest restOf(uint slot) {
  CellRest rest;
  rest.inverse = args.rests.at[slot].inverse;
  [[unroll]] for (uint k = 0; k < 4; ++k) rest.bent[k] = args.rests.at[slot].bent[k];
  rest.volume = args.rests.at[slot].volume;
  rest.bend = args.rests.at[slot].bend;
  return rest;
}

// Forces of the cell on its nodes, from the modes of its corners. Returns its compression.
float push(uint slot) {
  const SoftRules rules = softRules();
  if (kSculpted && args.rests.at[slot].volume > 0) {
    const CellRest rest = restOf(slot);
    forces = sculptedForces(rules, args.volumes.at[slot], rest, moved, velocity);
    return 1 - volumeShare(sculptedGradient(rules, rest, moved));
  }
  forces = cellForces(rules, args.volumes.at[slot], moved, velocity);
  return 1 - volumeShare(gradientOf(rules, moved) + mat3(1));
}

void main() {
  const uint slot = threadIndex();
  const bool isCell = holdsCell(slot), hasSkin = workgroupIndex() * kMatterBlock < args.firstInner;
  bool meets = false;
  float compression = 0;
  if (isCell) {
    readNodes(slot);
    meets = hasSkin && (kTries || mayMeet(slot));
    takeModes(moved);
    takeModes(velocity);
    compression = push(slot);
  }
  vec4 onWalls = vec4(0), compressed = vec4(0, 0, 0, max(compression, 0));
  if (hasSkin) {
    if (meets) onWalls.xyz = pressOnWalls(slot);
    meetTools(slot, meets);
  }
  if (hasSkin || args.ends != 0) {
    addUp(onWalls, compressed, true);
    if (hasSkin && args.begins == 0) onWalls += args.sums.at[workgroupIndex()];
    keepSums(0, onWalls, compressed);
  }
  if (!isCell) return;
  [[unroll]] for (uint k = 0; k < 8; ++k) {
    const uint word = 3 * k * args.stride + slot;
    args.forces.at[word] = forces.at[k].x;
    args.forces.at[word + args.stride] = forces.at[k].y;
    args.forces.at[word + 2 * args.stride] = forces.at[k].z;
  }
}
