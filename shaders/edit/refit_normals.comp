#version 460
#extension GL_GOOGLE_include_directive : require
// After points have moved and the index follows: the normal of every moved point becomes the direction of least spread
// of its neighbours (Hoppe et al. 1992, section 3.2), on the side of its old normal, and the point goes to the log as
// it is now. One subgroup for each point.
#include "shaders/lib/index.glsl"
#include "shaders/lib/edit_buffers.glsl"
#include "shaders/lib/eigen.glsl"
#include "shaders/lib/neighbours.glsl"
#include "shaders/lib/weight.glsl"

layout(push_constant, scalar) uniform Push { RefitNormalsArgs args; };

// Weighted moments of the neighbours about a place.
struct Moments {
  float weight;
  uint neighbours;
  vec3 mean;       // sum of w d
  vec3 diagonal;   // sums of w dx dx, w dy dy, w dz dz
  vec3 mixed;      // sums of w dx dy, w dy dz, w dz dx
  vec3 side;       // sum of w n, with the normals as they were
};
Moments moments;  // what this invocation has seen

void visitNeighbour(uint slot, vec4 position, vec3 d) {
  const float w = wendland(length(d) / args.radius);
  moments.weight += w;
  moments.neighbours += 1;
  moments.mean += w * d;
  moments.diagonal += w * d * d;
  moments.mixed += w * d * d.yzx;
  moments.side += w * args.cloud.normals.at[slot].xyz;
}

Moments momentsAbout(vec3 center) {
  moments = Moments(0.0, 0, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
  visitNeighbours(args.cloud, center, args.radius, kNeighbourWorkBudget);
  return Moments(subgroupAdd(moments.weight), subgroupAdd(moments.neighbours), subgroupAdd(moments.mean),
                 subgroupAdd(moments.diagonal), subgroupAdd(moments.mixed), subgroupAdd(moments.side));
}

// Its side is the one that most normals around it are on: at a fresh edge a normal may turn by a right angle in one
// tick, and its own old side says nothing then.
vec3 fittedNormal(vec3 center, vec3 old) {
  const Moments m = momentsAbout(center);
  vec3 normal = old;
  if (m.neighbours >= kMinNeighbours && m.weight > 0.0) {
    const vec3 mean = m.mean / m.weight;
    const vec3 diagonal = m.diagonal / m.weight - mean * mean;
    const vec3 mixed = m.mixed / m.weight - mean * mean.yzx;
    const vec3 fitted = smallestEigenvector(mat3(diagonal.x, mixed.x, mixed.z,  //
                                                 mixed.x, diagonal.y, mixed.y,  //
                                                 mixed.z, mixed.y, diagonal.z));
    if (dot(fitted, fitted) > 0.5) normal = dot(fitted, old) < 0.0 ? -fitted : fitted;
  }
  return dot(normal, m.side) < 0.0 ? -normal : normal;
}

uint nextEntry() { return atomicAdd(args.head.at[0], 1) & args.capacityMask; }

void logPoint(vec3 position, uint id, uint gone, vec3 normal) {
  const uint slot = nextEntry();
  args.entries.at[slot].position = position;
  args.entries.at[slot].id = id | gone;
  args.entries.at[slot].normal = normal;
  args.entries.at[slot].color = colorOf(args.tables, id);
  args.entries.at[slot].parent = parentOf(args.tables, id);
}

// Points that are taken away have no slot any more: the moves name them.
void logGone() {
  const uint moves = args.update.at[0].moves;
  if (args.update.at[0].gone == 0) return;
  for (uint i = threadIndex(); i < moves; i += gl_NumWorkGroups.x * gl_WorkGroupSize.x)
    if (args.moves.at[i].toBucket == kNoBucket)
      logPoint(args.moves.at[i].position, args.moves.at[i].id, kPointGone, args.moves.at[i].normal);
}

void main() {
  if (args.update.at[0].failed != 0) return;
  const uint changed = args.update.at[0].changed;
  const uint stride = gl_NumWorkGroups.x * gl_NumSubgroups;
  for (uint which = workgroupIndex() * gl_NumSubgroups + gl_SubgroupID; which < changed; which += stride) {
    const uint i = args.changed.at[which];
    const vec4 position = args.cloud.positions.at[i];
    const vec4 before = args.cloud.normals.at[i];
    vec3 normal = before.xyz;
    const bool refits = before.w == kMarkRefit;
    if (refits) normal = fittedNormal(position.xyz, normal);
    if (subgroupElect()) {
      const uint id = floatBitsToUint(position.w);
      args.fitted.at[which] = vec4(normal, 0.0);
      if (refits && resamples(args.lists)) args.tables.at[0].looks.at[id] = args.lists.now.tick;
      logPoint(position.xyz, id, 0, normal);
    }
  }
  logGone();
}
