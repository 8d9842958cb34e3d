// State of a simulation of matter, and the constants of its particles, read from memory field by field. Requires `args`
// with control and setting.
#ifndef PALPATE_LIB_MATTER_SETTING_GLSL
#define PALPATE_LIB_MATTER_SETTING_GLSL

#define SETTING args.setting.now

// Whether this substep has work, from predict on.
bool isRunning() {
  return args.control.now.state == kMatterRunning && args.control.now.farthest < kNotFinite &&
         args.control.now.crowdedCell == 0 && args.control.now.crowdedList == 0;
}

// Whether lists are to be made; valid in passes before the lists are made, in substeps that may make lists.
bool needsLists() {
  const float allowed = SETTING.allowed;
  return args.control.now.state == kMatterRunning && args.control.now.farthest < kNotFinite &&
         (args.control.now.lists == 0 || !(uintBitsToFloat(args.control.now.farthest) < allowed * allowed));
}

MatterCells particleCells() {
  return MatterCells(SETTING.cells.size, SETTING.cells.periodic, SETTING.cells.cellsPerMetre, SETTING.cells.cells);
}

WaterRules waterRules() {
  return WaterRules(SETTING.water.support, SETTING.water.restSum, SETTING.water.wallSum, SETTING.water.wallInset,
                    SETTING.water.push, SETTING.water.wallPush, SETTING.water.drag, SETTING.water.wallDrag,
                    SETTING.water.nearest, SETTING.water.step, SETTING.water.cohesion);
}

GrainRules grainRules() {
  return GrainRules(SETTING.grains.diameter, SETTING.grains.share, SETTING.grains.friction, SETTING.grains.step);
}

StoppingWalls stoppingWalls() {
  const MatterCells cells = particleCells();
  return StoppingWalls(cells.size, SETTING.nearest, SETTING.step, isPeriodic(cells, 0), isPeriodic(cells, 1),
                       isPeriodic(cells, 2));
}

// Effect of the walls on the pressure and the velocity of water at a position.
WallEffect wallsAt(WaterRules rules, vec3 place) {
  const MatterCells cells = particleCells();
  return wallEffect(rules, wallsBeside(rules, place.x, cells.size.x, isPeriodic(cells, 0)),
                    wallsBeside(rules, place.y, cells.size.y, isPeriodic(cells, 1)),
                    wallsBeside(rules, place.z, cells.size.z, isPeriodic(cells, 2)));
}

#endif
