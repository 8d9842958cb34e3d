#version 460
#extension GL_GOOGLE_include_directive : require
// The lattice: the value of every node of every present block. One workgroup for a part of a block.
#include "shaders/mesh/lattice.glsl"
const uint kLanes = gl_WorkGroupSize.x;
const uint kSharers = kMeshFieldSharers;
#include "shaders/mesh/block_surface.glsl"

// Neighbouring invocations have neighbouring nodes (Morton 1966), so that a brick is as compact as possible.
uvec3 nodeOfCode(uint code) {
  const uvec3 v = uvec3(code) >> uvec3(0, 1, 2);
  return v & 1 | v >> 2 & 2 | v >> 4 & 4;
}

void main() {
  const uint parts = kMeshBlockNodes / kPlaces;
  const uint slot = args.first + workgroupIndex() / parts, part = workgroupIndex() % parts;
  if (slot >= args.first + args.count) return;
  const uint first = part * kPlaces, code = first + placeIndex();
  const uvec3 block = blockOfNumber(args.lattice, args.buffers.at[0].blocks.at[slot]);
  MeshFloats values = args.buffers.at[0].now.values;
  if (args.update != 0 && args.buffers.at[0].touched.at[slot] == 0) {
    const uint before = slotOf(args.buffers.at[0].old.table, block);
    if (isFirstSharer())
      values.at[slot * kMeshBlockNodes + code] = args.buffers.at[0].old.values.at[before * kMeshBlockNodes + code];
    return;
  }
  const uvec3 base = block * kMeshBlockSide;
  const Box box = boxAround(nodePlace(args.lattice, base + nodeOfCode(first)),
                            nodePlace(args.lattice, base + nodeOfCode(first + kPlaces - 1)));
  const uint firstOfBrick = first + scanIndex() / kBrick * (kBrick / kSharers);
  const Brick brick =
      Brick(placeInBox(box, nodePlace(args.lattice, base + nodeOfCode(firstOfBrick))),
            placeInBox(box, nodePlace(args.lattice, base + nodeOfCode(firstOfBrick + kBrick / kSharers - 1))));
  const uvec3 node = nodeOfCode(code);
  const Surface surface = findSurface(box, brick, placeInBox(box, nodePlace(args.lattice, base + node)), true).surface;
  if (isFirstSharer())
    values.at[slot * kMeshBlockNodes + inBlock(node)] = surface.defined ? surface.distance : kMeshUndefined;
}
