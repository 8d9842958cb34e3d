// What of a round of cells belongs to a patch.
#ifndef PALPATE_LIB_CANDIDATES_GLSL
#define PALPATE_LIB_CANDIDATES_GLSL

#include "shaders/lib/cells.glsl"

// The candidate of the loaded round that stands at `candidate`, if it belongs to a patch.
struct Candidate {
  bool kept;
  uint point;
  vec3 place;
  vec3 normal;
};
Candidate candidateAt(CellBox box, uint firstCell, uint candidate, vec3 hip, vec3 centre,
                      float reach) {
  const uint slot = cellOfCandidate(candidate);
  Candidate found;
  found.point = cellFirst[slot] + candidate - cellStart[slot];
  const vec3 position = args.cloud.positions.at[found.point].xyz;
  found.normal = args.cloud.normals.at[found.point].xyz;  // of all of them: to ask for it later would be to wait twice
  found.place = placeInPatch(position, hip, centre);
  // Another cell of this gather may share the bucket: its points are taken once, when it is that cell's turn.
  found.kept = cellOf(args.cloud.grid, position) == cellAt(box, firstCell + slot) && inReach(found.place, reach);
  return found;
}

#endif
