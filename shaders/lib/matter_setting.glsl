// How a simulation of matter is, and what is the same for all of its particles, out of memory field by field. Whoever
// includes this has `args` with control and setting.
#ifndef PALPATE_LIB_MATTER_SETTING_GLSL
#define PALPATE_LIB_MATTER_SETTING_GLSL

#define SETTING args.setting.now

// Whether there is anything to do in this substep, from predict on.
bool isRunning() {
  return args.control.now.state == kMatterRunning && args.control.now.farthest < kNotFinite &&
         args.control.now.crowdedCell == 0 && args.control.now.crowdedList == 0;
}

// Whether lists are to be made, for passes before the lists are, and in substeps that make some.
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

// What the walls do to the pressure and the velocity of water at a place.
WallEffect wallsAt(WaterRules rules, vec3 place) {
  const MatterCells cells = particleCells();
  return wallEffect(rules, wallsBeside(rules, place.x, cells.size.x, isPeriodic(cells, 0)),
                    wallsBeside(rules, place.y, cells.size.y, isPeriodic(cells, 1)),
                    wallsBeside(rules, place.z, cells.size.z, isPeriodic(cells, 2)));
}

#endif
