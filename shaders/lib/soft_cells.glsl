// The cells of a soft body, out of memory. Whoever includes this has `args` with setting, nodes, corners, skinCount,
// firstInner and slots.
#ifndef PALPATE_LIB_SOFT_CELLS_GLSL
#define PALPATE_LIB_SOFT_CELLS_GLSL
#extension GL_EXT_control_flow_attributes : require

#define SETTING args.setting.now

SoftRules softRules() {
  return SoftRules(SETTING.rules.shear, SETTING.rules.bulk, SETTING.rules.restVolume, SETTING.rules.viscosity,
                   SETTING.rules.bend, SETTING.rules.twist, SETTING.rules.bendDrag, SETTING.rules.perEdges);
}

// Between the cells with skin and those without are slots that hold none.
bool holdsCell(uint slot) { return slot < args.skinCount || (slot >= args.firstInner && slot < args.slots); }

// Node of the corner `k`, of the four that corners at x = 0 have.
uint nodeAt(uvec4 corners, uint k) { return corners[k / 2] + k % 2; }

#endif
