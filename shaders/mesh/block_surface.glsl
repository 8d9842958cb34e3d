// The surface at many positions of a box. A workgroup loads the points in reach of any of them, piece by piece, into
// shared memory; every brick of neighbouring positions marks those in its own reach, a bit for each, and a few
// invocations share the points of each position. A point out of reach of a position adds zero, and the others are
// summed in an order that follows from the points within a support radius of the box: so the result depends on those
// alone. The including file defines kLanes, the invocations of a workgroup, a multiple of 32, and kSharers, those that
// share a position, a power of two up to 4.
#ifndef PALPATE_MESH_BLOCK_SURFACE_GLSL
#define PALPATE_MESH_BLOCK_SURFACE_GLSL

#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "shaders/lib/workgroup_scan.glsl"
#include "shaders/mesh/field.glsl"

layout(constant_id = 2) const bool kMeshColored = false;

const uint kPlaces = kLanes / kSharers;
const uint kBrick = 32;  // consecutive invocations whose positions are visited as one box; bits of a word
const uint kBricks = kLanes / kBrick;
// The points of a word that one invocation takes.
const uint kShare = kSharers == 1 ? 0xffffffffu : kSharers == 2 ? 0x55555555u : 0x11111111u;
// Points in shared memory, at least as many as invocations. With more points fewer workgroups run at a time, with fewer
// points the bricks take more passes.
layout(constant_id = 3) const uint kPiece = 512;
// Candidates that an invocation loads at a time, so that their latencies overlap. More take registers, and with them
// room for other workgroups: 4 of them made an H200 a third slower.
const uint kFetched = 2;
const uint kPieceWords = kPiece / kBrick;
// Maximum rounding error of a squared distance, support radii: a brick must not miss a point.
const float kSlack = 1e-4;

struct Answer {
  Surface surface;
  vec4 colors;  // sum of w c, sum of w
};

// Of the position of this invocation.
FieldSums placeSums;
vec4 colorSums;
shared uint cellStart[kLanes];  // candidates before this cell's, in this round
shared uint cellFirst[kLanes];  // its first point
// Position in the box, support radii, and normal: two wide loads for each point.
shared vec4 piecePlaces[kPiece];  // and the normal's x
shared vec2 pieceNormals[kPiece];
shared uint pieceColors[kMeshColored ? kPiece : 1];
shared uint seenByBrick[kBricks * kPieceWords];
uint pieceCount = 0;

struct Box {
  vec3 low, high;  // around the positions, model units
  vec3 middle;
  ivec3 firstCell;
  uvec3 size;
  uint cells;
};

Box boxAround(vec3 low, vec3 high) {
  const float margin = 1.0001 * args.lattice.radius;
  Box box;
  box.low = low;
  box.high = high;
  box.middle = 0.5 * (low + high);
  box.firstCell = cellOf(args.cloud.grid, low - margin);
  box.size = uvec3(cellOf(args.cloud.grid, high + margin) - box.firstCell + 1);
  box.cells = box.size.x * box.size.y * box.size.z;
  return box;
}

uvec2 rangeOf(Box box, uint c) {
  if (c >= box.cells) return uvec2(0);
  const uint row = c / box.size.x;
  const ivec3 cell = box.firstCell + ivec3(c % box.size.x, row % box.size.y, row / box.size.y);
  return args.cloud.ranges.at[bucketOf(args.cloud.grid, cell)];
}

bool isInCell(Box box, vec3 point, uint c) {
  const uvec3 cell = uvec3(cellOf(args.cloud.grid, point) - box.firstCell);
  return all(lessThan(cell, box.size)) && (cell.z * box.size.y + cell.y) * box.size.x + cell.x == c;
}

// The last of the round's cells whose candidates begin at or before `candidate`.
uint cellOfCandidate(uint candidate) {
  uint cell = 0;
  for (uint step = kLanes / 2; step > 0; step /= 2)
    if (cellStart[cell + step] <= candidate) cell += step;
  return cell;
}

// Position relative to the middle of the box, support radii.
vec3 placeInBox(Box box, vec3 place) { return (place - box.middle) / args.lattice.radius; }

// The box around the positions of a brick, as placeInBox().
struct Brick {
  vec3 low, high;
};

// Each invocation tests a point of a word against its own brick.
void findSeen(Brick brick) {
  const uint lane = scanIndex();
  for (uint i = lane; i < kBricks * kPieceWords; i += kLanes) seenByBrick[i] = 0;
  barrier();
  for (uint word = 0; word * kBrick < pieceCount; ++word) {
    const uint i = word * kBrick + lane % kBrick;
    const vec3 place = piecePlaces[i].xyz;
    const vec3 away = place - clamp(place, brick.low, brick.high);
    const uvec4 seen = subgroupBallot(i < pieceCount && dot(away, away) < 1.0 + kSlack);
    // Subgroups may be smaller than a brick or larger.
    if (gl_SubgroupInvocationID % kBrick == 0)
      atomicOr(seenByBrick[lane / kBrick * kPieceWords + word],
               seen[gl_SubgroupInvocationID / kBrick] << (lane % kBrick));
  }
  barrier();
}

void sumPiece(vec3 place, Brick brick, bool wanted, Surface before) {
  findSeen(brick);
  const uint firstWord = scanIndex() / kBrick * kPieceWords;
  const uint share = kShare << scanIndex() % kSharers;
  for (uint word = 0; word * kBrick < pieceCount && wanted; ++word)
    for (uint bits = seenByBrick[firstWord + word] & share; bits != 0; bits &= bits - 1) {
      const uint i = word * kBrick + findLSB(bits);
      const vec4 point = piecePlaces[i];
      const float w = addPoint(placeSums, point.xyz - place, vec3(point.w, pieceNormals[i]), before);
      if (kMeshColored) colorSums += w * vec4(unpackUnorm4x8(pieceColors[i]).rgb, 1.0);
    }
  barrier();
}

void putInPiece(uint at, Box box, vec3 position, vec3 normal, uint id) {
  piecePlaces[at] = vec4(placeInBox(box, position), normal.x);
  pieceNormals[at] = normal.yz;
  if (kMeshColored) pieceColors[at] = args.buffers.at[0].colors.at[id];
}

// The candidates of as many cells as there are invocations, each of which holds those of its own cell.
struct Round {
  uvec2 range;  // of points
  uint start;   // candidates before them
  uint total;   // in the round
};
Round roundOf(Box box, uint firstCell) {
  Round here;
  here.range = rangeOf(box, firstCell + scanIndex());
  here.start = workgroupExclusiveScan(here.range.y - here.range.x, here.total);
  return here;
}

// One pass over all points in reach of the box, of which every `stride`th is taken. `cells`: the first round of them.
void sumBox(Box box, Round cells, uint stride, vec3 place, Brick brick, bool wanted, Surface before) {
  const uint lane = scanIndex();
  const float radius = 1.0001 * args.lattice.radius;
  pieceCount = 0;
  for (uint firstCell = 0; firstCell < box.cells; firstCell += kLanes) {
    if (firstCell > 0) cells = roundOf(box, firstCell);
    cellStart[lane] = cells.start;
    cellFirst[lane] = cells.range.x;
    barrier();
    for (uint base = 0; base < cells.total; base += kLanes * kFetched * stride) {
      vec4 points[kFetched];
      vec3 normals[kFetched];
      uint near = 0;  // a bit for each that is
      for (uint k = 0; k < kFetched; ++k) {
        const uint candidate = base + (lane * kFetched + k) * stride;
        points[k] = vec4(0.0);
        normals[k] = vec3(0.0);
        if (candidate >= cells.total) continue;
        const uint owner = cellOfCandidate(candidate);
        const uint slot = cellFirst[owner] + candidate - cellStart[owner];
        points[k] = args.cloud.positions.at[slot];
        normals[k] = args.cloud.normals.at[slot].xyz;  // at once, though few are needed: a second wait costs more
        const vec3 away = points[k].xyz - clamp(points[k].xyz, box.low, box.high);
        // Another cell of the box may share the bucket: its points are taken with that cell.
        if (!(dot(away, away) < radius * radius) || !isInCell(box, points[k].xyz, firstCell + owner)) continue;
        near |= 1u << k;
      }
      uint found;
      const uint at = pieceCount + workgroupExclusiveScan(bitCount(near), found);
      const uint end = pieceCount + found;
      for (uint first = 0; first <= end; first += kPiece) {
        for (uint k = 0; k < kFetched; ++k) {
          const uint there = at + bitCount(near & ((1u << k) - 1)) - first;
          if ((near >> k & 1) != 0 && there < kPiece)
            putInPiece(there, box, points[k].xyz, normals[k], floatBitsToUint(points[k].w));
        }
        pieceCount = min(end - first, kPiece);
        if (pieceCount == kPiece) sumPiece(place, brick, wanted, before);
      }
    }
    barrier();
  }
  sumPiece(place, brick, wanted, before);
}

// All sharers get the same sums.
void joinShares() {
  for (uint step = 1; step < kSharers; step *= 2) {
    placeSums.surface.offsets += subgroupShuffleXor(placeSums.surface.offsets, step);
    placeSums.surface.normals += subgroupShuffleXor(placeSums.surface.normals, step);
    placeSums.surface.products += subgroupShuffleXor(placeSums.surface.products, step);
    if (kMeshSurface == kSurfaceDensity) placeSums.slope += subgroupShuffleXor(placeSums.slope, step);
    if (kMeshColored) colorSums += subgroupShuffleXor(colorSums, step);
  }
}

// Index of this invocation's position among those of the workgroup.
uint placeIndex() { return scanIndex() / kSharers; }
bool isFirstSharer() { return scanIndex() % kSharers == 0; }

// The surface at `place`, as placeInBox(), if it is wanted; all positions are in the box, and those of a brick in the
// brick. The whole workgroup calls it together.
Answer findSurface(Box box, Brick brick, vec3 place, bool wanted) {
  const Round cells = roundOf(box, 0);
  uint candidates = cells.total;
  if (box.cells > kLanes) {
    uint own = 0;
    for (uint c = scanIndex(); c < box.cells; c += kLanes) {
      const uvec2 range = rangeOf(box, c);
      own += min(range.y - range.x, 1u << 22);
    }
    workgroupExclusiveScan(own, candidates);
  }
  Surface surface = kNoSurface;
  for (uint pass = 0; pass < kFieldPasses; ++pass) {
    placeSums = noSums();
    colorSums = vec4(0.0);
    sumBox(box, cells, strideFor(candidates), place, brick, wanted, surface);
    joinShares();
    const Surface next = surfaceOf(placeSums);
    if (next.defined) surface = next;
  }
  return Answer(surface, colorSums);
}

#endif
