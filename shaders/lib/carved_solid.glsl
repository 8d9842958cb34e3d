// While a ball carves: which points, and which positions of new ones, are outside of the solid that it cuts. Part of
// request.comp, with its globals. In double precision, with the reasons: engine/edit/resampling.cpp.
#ifndef PALPATE_LIB_CARVED_SOLID_GLSL
#define PALPATE_LIB_CARVED_SOLID_GLSL

// For a carving ball: adds the vote of a neighbour, `d` away from a position, on whether that has risen.
void noteRisen(uint at, vec3 normal, vec3 d, float margin) {
  const uint id = keptIds[at];
  const float far = length(d);
  if (far == 0.0 || !isAtRest(center + keptOffset(at), rests.at[id], targetOf(id))) return;
  const float share = self.spacing / far, weight = share * share * share * share;
  votes += weight * vec2(isAbove(-d, normal, self.spacing, margin) ? 1.0 : 0.0, 1.0);
}

// For a cutting ball: depth of a neighbour of the far sheet under the point as found.
void noteFarSheet(vec3 normal, vec3 d) {
  if (dot(normal, foundNormal) > kFarSheet) return;
  const float along = dot(d, foundNormal), deep = dot(foundAt, foundNormal) - along;
  const vec3 aside = d - along * foundNormal;
  if (deep > 0.0 && dot(aside, aside) < kBeside * kBeside * self.spacing * self.spacing) free = min(free, deep);
}

// For a carving ball: whether one neighbour indicates that the point is outside the solid.
void noteOutside(uint at, vec3 normal, vec3 d) {
  if (dot(self.normal, normal) <= kFarSheet)
    through = through || isThrough(-d, normal, self.spacing, 0.0);
  else
    noteRisen(at, normal, d, 0.0);
}

// Blocks new points that would be through the sheet of a neighbour that faces the other way.
void noteThrough(uint slot, vec3 d) {
  const vec3 normal = args.cloud.normals.at[slot].xyz;
  if (dot(self.normal, normal) > kFarSheet) return;
  for (uint s = 0; s < kGapSectors; ++s)
    if (isThrough(sectors[sectorAt(s)].offset - d, normal, self.spacing, kBirthMargin)) blocked |= 1u << s;
}

bool hasRisen(float share) {
  const vec2 all = reduceAdd(votes);
  return all.x > share * all.y;
}

// Takes the depth of the far sheet from the neighbours, or else the last known one.
void noteThickness() {
  const uint id = self.rank & ~kExamined;
  const bool isNoted = args.tables.at[0].founds.at[id].stroke == tool.stroke;
  free = reduceMin(free);
  if (free == kUnseen && isNoted) free = args.tables.at[0].founds.at[id].room;
  else if (isNoted && subgroupElect()) args.tables.at[0].founds.at[id].room = free;
}

// Whether a carving ball has removed the point, or brought it outside the solid.
bool isOutside() {
  if (!carves) return false;
  if (cuts) noteThickness();
  if (swallowed) return true;
  if (!moved) return false;
  const bool isBelow = cuts && dot(foundAt, foundNormal) > free - kSkin * self.spacing;
  return isBelow || subgroupAny(through) || hasRisen(kNearlyAll);
}

#endif
