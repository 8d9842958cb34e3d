#version 460
#extension GL_GOOGLE_include_directive : require
// Places every vertex on its edge. One invocation for each vertex.
#include "shaders/mesh/field.glsl"

float valueAt(uvec3 node) {
  const NodeSlot at = nodeSlot(args.buffers.at[0].now.table, node);
  return args.buffers.at[0].now.values.at[at.slot * kMeshBlockNodes + at.place];
}

vec3 between(vec3 low, uint axis, float t) {
  low[axis] += t * args.lattice.cell;
  return low;
}

// Where between a value of one sign and one of the other a straight line is zero.
float crossing(float from, float fromValue, float to, float toValue) {
  return from + (to - from) * (fromValue / (fromValue - toValue));
}

void main() {
  const uint vertex = threadIndex();
  if (vertex >= args.count) return;
  const uint slot = lastNotAbove(args.buffers.at[0].now.vertexStarts, 0, args.slots, vertex);
  const uint local = vertex - args.buffers.at[0].now.vertexStarts.at[slot];
  const uint word = lastNotAbove(args.buffers.at[0].ranks, slot * kMeshMaskWords, kMeshMaskWords, local);
  uint mask = args.buffers.at[0].masks.at[slot * kMeshMaskWords + word];
  for (uint k = args.buffers.at[0].ranks.at[slot * kMeshMaskWords + word]; k < local; ++k) mask &= mask - 1;
  const uint bit = findLSB(mask), axis = bit % 4;
  const uvec3 block = blockOfNumber(args.lattice, args.buffers.at[0].blocks.at[slot]);
  MeshVertices vertices = args.buffers.at[0].now.vertices;

  if (args.update != 0 && args.buffers.at[0].touched.at[slot] == 0) {
    const uint before = slotOf(args.buffers.at[0].old.table, block);
    const uint from = args.buffers.at[0].old.vertexStarts.at[before] + local;
    vertices.at[vertex].position = args.buffers.at[0].old.vertices.at[from].position;
    vertices.at[vertex].normal = args.buffers.at[0].old.vertices.at[from].normal;
    vertices.at[vertex].color = args.buffers.at[0].old.vertices.at[from].color;
    return;
  }

  const uvec3 node = block * kMeshBlockSide + localOf(word * kMeshNodesPerWord + bit / 4);
  uvec3 next = node;
  next[axis] += 1;
  const float low = valueAt(node), high = valueAt(next);
  const vec3 corner = nodePlace(args.lattice, node);
  // The surface is no straight line between two nodes: look where the line is zero, and draw it again from there to
  // the node on the other side (one step of the false position).
  float t = crossing(0.0, low, 1.0, high);
  const FieldSample there = fieldAt(between(corner, axis, t), kMeshColored);
  if (there.defined) t = (there.value < 0.0) == (low < 0.0) ? crossing(t, there.value, 1.0, high) : crossing(0.0, low, t, there.value);
  vec3 normal = there.normal;
  if (dot(normal, normal) < 0.5) normal[axis] = low < 0.0 ? 1.0 : -1.0;
  vertices.at[vertex].position = between(corner, axis, clamp(t, kMeshClearance, 1.0 - kMeshClearance));
  vertices.at[vertex].normal = normal;
  vertices.at[vertex].color = kMeshColored && there.color.a > 0.0 ? packUnorm4x8(vec4(there.color.rgb / there.color.a, 1.0)) : 0;
}
