#version 460
#extension GL_GOOGLE_include_directive : require
// Computes the position of every vertex on its edge. One workgroup for each block.
#include "shaders/mesh/lattice.glsl"
const uint kLanes = kMeshVertexWorkgroup;
const uint kSharers = kMeshVertexSharers;
#include "shaders/mesh/block_surface.glsl"

// Bounds of each brick, as placeInBox() and raised above zero, where the bits of floats are ordered like the floats.
shared uint brickLow[3 * kBricks], brickHigh[3 * kBricks];
const float kRaise = 64.0;

Brick brickAround(vec3 place, bool wanted) {
  const uint first = scanIndex() / kBrick * 3, inBrick = scanIndex() % kBrick;
  if (inBrick < 3) {
    brickLow[first + inBrick] = 0xffffffffu;
    brickHigh[first + inBrick] = 0;
  }
  barrier();
  Brick brick;
  for (uint k = 0; k < 3; ++k) {
    const uint raised = floatBitsToUint(place[k] + kRaise);
    const uint low = reduceMin(wanted ? raised : 0xffffffffu), high = reduceMax(wanted ? raised : 0);
    if (gl_SubgroupInvocationID % kBrick != 0) continue;
    atomicMin(brickLow[first + k], low);
    atomicMax(brickHigh[first + k], high);
  }
  barrier();
  for (uint k = 0; k < 3; ++k) {
    brick.low[k] = uintBitsToFloat(brickLow[first + k]) - kRaise;
    brick.high[k] = uintBitsToFloat(brickHigh[first + k]) - kRaise;
  }
  return brick;
}

float valueAt(uvec3 node) {
  const NodeSlot at = nodeSlot(args.buffers.at[0].now.table, node);
  return args.buffers.at[0].now.values.at[at.slot * kMeshBlockNodes + at.place];
}

// The zero of a straight line between values of opposite signs, in edges.
float crossing(float from, float fromValue, float to, float toValue) {
  return from + (to - from) * (fromValue / (fromValue - toValue));
}

// An edge that holds a vertex, with the values at its ends.
struct CutEdge {
  vec3 corner;  // its lower end
  uint axis;
  float low, high;
};

// The edge of the `local`th vertex of a block.
CutEdge edgeOf(uint slot, uvec3 block, uint local) {
  const uint word = lastNotAbove(args.buffers.at[0].ranks, slot * kMeshMaskWords, kMeshMaskWords, local);
  uint mask = args.buffers.at[0].masks.at[slot * kMeshMaskWords + word];
  for (uint k = args.buffers.at[0].ranks.at[slot * kMeshMaskWords + word]; k < local; ++k) mask &= mask - 1;
  const uint bit = findLSB(mask);
  const uvec3 node = block * kMeshBlockSide + localOf(word * kMeshNodesPerWord + bit / 4);
  uvec3 next = node;
  next[bit % 4] += 1;
  return CutEdge(nodePlace(args.lattice, node), bit % 4, valueAt(node), valueAt(next));
}

vec3 alongEdge(CutEdge edge, float t) {
  vec3 place = edge.corner;
  place[edge.axis] += t * args.lattice.cell;
  return place;
}

void copyOld(uvec3 block, uint first, uint count) {
  const uint before = slotOf(args.buffers.at[0].old.table, block);
  const uint from = args.buffers.at[0].old.vertexStarts.at[before];
  MeshVertices vertices = args.buffers.at[0].now.vertices;
  MeshVertices old = args.buffers.at[0].old.vertices;
  for (uint i = scanIndex(); i < count; i += kLanes) {
    vertices.at[first + i].position = old.at[from + i].position;
    vertices.at[first + i].normal = old.at[from + i].normal;
    vertices.at[first + i].color = old.at[from + i].color;
  }
}

// The surface is not linear between two nodes: it was evaluated where the straight line is zero, and the line is drawn
// again from there to the node on the other side (one step of the false position method).
void writeVertex(uint vertex, CutEdge edge, Answer there) {
  float t = crossing(0.0, edge.low, 1.0, edge.high);
  const float value = there.surface.distance;
  if (there.surface.defined)
    t = (value < 0.0) == (edge.low < 0.0) ? crossing(t, value, 1.0, edge.high) : crossing(0.0, edge.low, t, value);
  vec3 normal = there.surface.normal;
  if (dot(normal, normal) < 0.5) normal[edge.axis] = edge.low < 0.0 ? 1.0 : -1.0;
  MeshVertices vertices = args.buffers.at[0].now.vertices;
  vertices.at[vertex].position = alongEdge(edge, clamp(t, kMeshClearance, 1.0 - kMeshClearance));
  vertices.at[vertex].normal = normal;
  vertices.at[vertex].color =
      kMeshColored && there.colors.a > 0.0 ? packUnorm4x8(vec4(there.colors.rgb / there.colors.a, 1.0)) : 0;
}

void main() {
  const uint slot = args.first + workgroupIndex();
  if (slot >= args.first + args.count) return;
  const uint first = args.buffers.at[0].now.vertexStarts.at[slot];
  const uint count = args.buffers.at[0].now.vertexStarts.at[slot + 1] - first;
  if (count == 0) return;
  const uvec3 block = blockOfNumber(args.lattice, args.buffers.at[0].blocks.at[slot]);
  if (args.update != 0 && args.buffers.at[0].touched.at[slot] == 0) {
    copyOld(block, first, count);
    return;
  }
  const Box box = boxAround(nodePlace(args.lattice, block * kMeshBlockSide),
                            nodePlace(args.lattice, block * kMeshBlockSide + kMeshBlockSide));
  for (uint base = 0; base < count; base += kPlaces) {
    const uint local = base + placeIndex();
    const bool wanted = local < count;
    const CutEdge edge = edgeOf(slot, block, min(local, count - 1));
    const vec3 place = placeInBox(box, alongEdge(edge, crossing(0.0, edge.low, 1.0, edge.high)));
    const Answer there = findSurface(box, brickAround(place, wanted), place, wanted);
    if (wanted && isFirstSharer()) writeVertex(first + local, edge, there);
  }
}
