// The surface at many places of a box: a workgroup fetches the points that any of them may see, piece by piece, into
// shared memory, and each invocation sums over them for its own place. A place sees its points in the order of
// the hash cells, and then of the points, whatever else is near; so what comes out depends on those points alone.
#ifndef PALPATE_MESH_BLOCK_SURFACE_GLSL
#define PALPATE_MESH_BLOCK_SURFACE_GLSL

#include "shaders/lib/workgroup_scan.glsl"
#include "shaders/mesh/field.glsl"

layout(constant_id = 2) const bool kMeshColored = false;

const uint kPiece = 2 * kMeshWorkgroup;  // points in shared memory; a round adds kMeshWorkgroup at most

struct Answer {
  Surface surface;
  vec4 colors;  // sum of w c, sum of w
};

// Of the place of this invocation.
FieldSums placeSums;
vec4 colorSums;
shared uint cellStart[kMeshWorkgroup];  // candidates before this cell's, in this round
shared uint cellFirst[kMeshWorkgroup];  // its first point
shared vec3 piecePositions[kPiece];
shared vec3 pieceNormals[kPiece];
shared uint pieceColors[kPiece];
uint pieceCount = 0;

struct Box {
  vec3 low, high;  // around the places, model units
  ivec3 firstCell;
  uvec3 size;
  uint cells;
};

Box boxAround(vec3 low, vec3 high) {
  const float margin = 1.0001 * args.lattice.radius;
  Box box;
  box.low = low;
  box.high = high;
  box.firstCell = cellOf(args.cloud.grid, low - margin);
  box.size = uvec3(cellOf(args.cloud.grid, high + margin) - box.firstCell + 1);
  box.cells = box.size.x * box.size.y * box.size.z;
  return box;
}

ivec3 cellAt(Box box, uint c) {
  return box.firstCell + ivec3(c % box.size.x, c / box.size.x % box.size.y, c / (box.size.x * box.size.y));
}

uvec2 rangeOf(Box box, uint c) {
  return c < box.cells ? args.cloud.ranges.at[bucketOf(args.cloud.grid, cellAt(box, c))] : uvec2(0);
}

// Of the round's cells the last whose candidates begin at or before `candidate`.
uint cellOfCandidate(uint candidate) {
  uint cell = 0;
  for (uint step = kMeshWorkgroup / 2; step > 0; step /= 2)
    if (cellStart[cell + step] <= candidate) cell += step;
  return cell;
}

void sumPiece(vec3 place, bool wanted, Surface before) {
  barrier();
  const float scale = 1.0 / args.lattice.radius;
  for (uint i = 0; i < pieceCount && wanted; ++i) {
    const vec3 d = (piecePositions[i] - place) * scale;
    if (dot(d, d) >= 1.0) continue;
    const float w = addPoint(placeSums, d, pieceNormals[i], before);
    if (kMeshColored) colorSums += w * vec4(unpackUnorm4x8(pieceColors[i]).rgb, 1.0);
  }
  pieceCount = 0;
  barrier();
}

// One look at all points that the box sees, of which every `stride`th is taken.
void sumBox(Box box, uint stride, vec3 place, bool wanted, Surface before) {
  const uint lane = scanIndex();
  const float radius = 1.0001 * args.lattice.radius;
  for (uint firstCell = 0; firstCell < box.cells; firstCell += kMeshWorkgroup) {
    const uvec2 range = rangeOf(box, firstCell + lane);
    uint total;
    cellStart[lane] = workgroupExclusiveScan(range.y - range.x, total);
    cellFirst[lane] = range.x;
    barrier();
    for (uint base = 0; base < total; base += kMeshWorkgroup * stride) {
      const uint candidate = base + lane * stride;
      bool near = false;
      uint slot = 0;
      vec4 point;
      if (candidate < total) {
        const uint owner = cellOfCandidate(candidate);
        slot = cellFirst[owner] + candidate - cellStart[owner];
        point = args.cloud.positions.at[slot];
        const vec3 away = point.xyz - clamp(point.xyz, box.low, box.high);
        // Another cell of the box may share the bucket: its points are taken as that one's.
        near = dot(away, away) < radius * radius &&
               cellOf(args.cloud.grid, point.xyz) == cellAt(box, firstCell + owner);
      }
      uint found;
      const uint at = pieceCount + workgroupExclusiveScan(near ? 1 : 0, found);
      if (near) {
        piecePositions[at] = point.xyz;
        pieceNormals[at] = args.cloud.normals.at[slot].xyz;
        if (kMeshColored) pieceColors[at] = args.buffers.at[0].colors.at[floatBitsToUint(point.w)];
      }
      pieceCount += found;
      if (pieceCount > kPiece - kMeshWorkgroup) sumPiece(place, wanted, before);
    }
    barrier();
  }
  sumPiece(place, wanted, before);
}

// The surface at `place`, if it is wanted; all places lie in the box from `low` to `high`. The whole workgroup calls it
// together.
Answer findSurface(vec3 low, vec3 high, vec3 place, bool wanted) {
  const Box box = boxAround(low, high);
  uint own = 0, candidates;
  for (uint c = scanIndex(); c < box.cells; c += kMeshWorkgroup) {
    const uvec2 range = rangeOf(box, c);
    own += min(range.y - range.x, 1u << 24);
  }
  workgroupExclusiveScan(own, candidates);
  Surface surface = kNoSurface;
  for (uint pass = 0; pass < kFieldPasses; ++pass) {
    placeSums = noSums();
    colorSums = vec4(0.0);
    sumBox(box, strideFor(candidates), place, wanted, surface);
    const Surface next = surfaceOf(placeSums);
    if (next.defined) surface = next;
  }
  return Answer(surface, colorSums);
}

#endif
