// The cells of a soft body, read from memory. Requires `args` with setting, nodes, corners, skinCount, firstInner and
// slots.
#ifndef PALPATE_LIB_SOFT_CELLS_GLSL
#define PALPATE_LIB_SOFT_CELLS_GLSL
#extension GL_EXT_control_flow_attributes : require

#define SETTING args.setting.now

SoftRules softRules() {
  return SoftRules(SETTING.rules.shear, SETTING.rules.bulk, SETTING.rules.restVolume, SETTING.rules.viscosity,
                   SETTING.rules.bend, SETTING.rules.twist, SETTING.rules.bendDrag, SETTING.rules.perEdges);
}

// Slots between the cells with skin and those without are empty.
bool holdsCell(uint slot) { return slot < args.skinCount || (slot >= args.firstInner && slot < args.slots); }

// Node of corner `k`; `corners` holds the four nodes at x = 0.
uint nodeAt(uvec4 corners, uint k) { return corners[k / 2] + k % 2; }

Corners displacementsOf(uint slot) {
  const uvec4 corners = args.corners.at[slot];
  Corners moved;
  [[unroll]] for (uint k = 0; k < 8; ++k) moved.at[k] = args.nodes.at[kNodeVec4s * nodeAt(corners, k)].xyz;
  return moved;
}

// The box around all skin points of a cell; `corner`: its lowest one at rest.
void boxOf(vec3 corner, Corners moved, out vec3 low, out vec3 high) {
  const float spacing = SETTING.spacing;
  low = corner + moved.at[0];
  high = low;
  [[unroll]] for (uint k = 1; k < 8; ++k) {
    const vec3 place = corner + spacing * vec3(k & 1, k / 2 & 1, k / 4) + moved.at[k];
    low = min(low, place);
    high = max(high, place);
  }
  const vec3 over = SETTING.beyond * (high - low);
  low -= over;
  high += over;
}

#endif
