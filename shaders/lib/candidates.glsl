// Selects the points of a round of cells that belong to a patch.
#ifndef PALPATE_LIB_CANDIDATES_GLSL
#define PALPATE_LIB_CANDIDATES_GLSL

#include "shaders/lib/cells.glsl"

// The candidate with the number `candidate` in the loaded round, and whether it belongs to a patch.
struct Candidate {
  bool kept;
  uint point;
  vec4 place;  // and the bits of its id
  vec3 normal;
};
Candidate candidateAt(CellBox box, uint firstCell, uint candidate, vec3 hip, vec3 centre,
                      float reach) {
  const uint slot = cellOfCandidate(candidate);
  Candidate found;
  found.point = cellFirst[slot] + candidate - cellStart[slot];
  const vec4 position = args.cloud.positions.at[found.point];
  found.normal = args.cloud.normals.at[found.point].xyz;  // of all of them: a later load would be a second wait
  found.place = vec4(placeInPatch(position.xyz, hip, centre), position.w);
  // Another cell of this gather may share the bucket: its points are taken once, with that cell.
  found.kept =
      cellOf(args.cloud.grid, position.xyz) == cellAt(box, firstCell + slot) && inReach(found.place.xyz, reach);
  return found;
}

#endif
