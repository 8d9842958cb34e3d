// Sides of the surface as strokes found it: the one to which a stroke has carried a normal, and whether a gap may be
// filled. Part of request.comp, with its globals. In double precision: onCarriedSide() of
// engine/edit/cpu_refit.cpp, and mayBeFilled() of resampling.cpp.
#ifndef PALPATE_LIB_FOUND_SIDES_GLSL
#define PALPATE_LIB_FOUND_SIDES_GLSL

void noteCarried(uint at, vec3 normal, vec3 d) {
  const Found own = args.tables.at[0].founds.at[selfId];
  const Found found = args.tables.at[0].founds.at[keptIds[at]];
  if (found.stroke > own.stroke) return;  // moved since by a later one
  const bool both = found.stroke == own.stroke;
  addCarried(carriedSums, carriedFrom(own.position, own.normal), d, axisU, axisV, both ? found.position : center + d,
             both ? found.normal : normal, neighbourhoodRadius(self.spacing, args.radius));
}

// Notes the carried normal, by which the next edit corrects the side of the point's. True if it has to.
bool noteSide() {
  const vec4 found = subgroupSum(vec4(carriedSums.found, carriedSums.weight));
  const vec3 present = subgroupSum(vec4(carriedSums.present, 0.0)).xyz;
  const float side = carriedSide(CarriedSums(subgroupSum(carriedSums.means), subgroupSum(carriedSums.products),
                                             found.xyz, present, 1.0 + found.w));
  const bool isTurned = side < kTurnedOver;
  if (subgroupElect()) {
    const vec3 carried = isTurned ? -self.normal : self.normal;
    args.tables.at[0].carried.at[selfId] = isTurned || side > -kTurnedOver ? packedCarried(carried) : 0;
  }
  return isTurned;
}

// The ends of a gap as the last stroke that moved any of them found them.
struct FoundEnds {
  vec3 position, normal;
  vec3 otherPosition, otherNormal;
  bool areFound;  // false: as they are, since no stroke has moved them
};
FoundEnds foundEnds(uint otherId, uint otherSlot) {
  FoundEnds ends = FoundEnds(center, self.normal, args.cloud.positions.at[otherSlot].xyz,
                             args.cloud.normals.at[otherSlot].xyz, false);
  const Found own = args.tables.at[0].founds.at[selfId], other = args.tables.at[0].founds.at[otherId];
  ends.areFound = max(own.stroke, other.stroke) > 0;
  if (own.stroke > 0 && own.stroke >= other.stroke) {
    ends.position = own.position;
    ends.normal = own.normal;
  }
  if (other.stroke > 0 && other.stroke >= own.stroke) {
    ends.otherPosition = other.position;
    ends.otherNormal = other.normal;
  }
  return ends;
}

// Whether a gap may be filled, if a stroke has moved any of its ends.
bool mayBeFilled(FoundEnds ends, Sector gap) {
  const GapAsFound found = GapAsFound(rests.at[gap.id] - self.rest, ends.otherPosition - ends.position, ends.normal,
                                      ends.otherNormal);
  return !ends.areFound || (areOneSide(found) && (carves || hasOpened(found, gap.offset, gap.spacing)));
}

#endif
