// The boxes around the skin points of a soft body, cell by cell. Requires `args` with incident, boxes, stride and
// skinCount.
#ifndef PALPATE_LIB_SOFT_BOXES_GLSL
#define PALPATE_LIB_SOFT_BOXES_GLSL

// The slot of the k-th of eight cells around a node.
uint slotAbout(uint node, uint k) { return args.incident.at[kIncidentUVec4s * node + k / 4][k % 4] % args.stride; }

bool isInReach(vec3 middle, float radius, vec3 low, vec3 high) {
  const vec3 away = max(max(low - middle, middle - high), vec3(0));
  return dot(away, away) < radius * radius;
}

bool cellIsInReach(uint slot, vec3 middle, float radius) {
  return slot < args.skinCount && isInReach(middle, radius, args.boxes.at[kBoxVec4s * slot].xyz,
                                            args.boxes.at[kBoxVec4s * slot + 1].xyz);
}

#endif
