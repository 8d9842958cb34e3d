// The points of a tool's ball near a position, in the order of their cells. Requires `args` with setting, tools,
// bodyPoints and bodyFirsts; the including file defines the processing of a point.
#ifndef PALPATE_LIB_MATTER_BODY_GLSL
#define PALPATE_LIB_MATTER_BODY_GLSL

void meetPoint(BodyMeeting met, uint number);

BodyPose poseOf(uint tool) {
  return BodyPose(args.tools.at[tool].place, args.tools.at[tool].velocity, args.tools.at[tool].spin,
                  mat3(args.tools.at[tool].x, args.tools.at[tool].y, args.tools.at[tool].z), args.tools.at[tool].grown);
}

bool isNear(BodyPose pose, vec3 place) {
  const vec3 away = place - pose.place;
  return dot(away, away) < SETTING.bodyReach * SETTING.bodyReach;
}

void meetPoints(BodyPose pose, vec3 place) {
  const MatterCells cells =
      MatterCells(SETTING.bodyCells.size, 0, SETTING.bodyCells.cellsPerMetre, SETTING.bodyCells.cells);
  const float support = SETTING.bodySupport;
  const vec3 here = inBody(pose, place) + SETTING.bodyMiddle;
  const ivec3 cell = cellOf(cells, here);
  const CellRun x = runAlong(cell.x, cells.cells.x, false, 1);
  for (int row = 0; row < kRowsAbout; ++row) {
    const CellAlong y = cellAlong(cell.y + row % kRowsWide - kCellsBeside, cells.cells.y, false);
    const CellAlong z = cellAlong(cell.z + row / kRowsWide - kCellsBeside, cells.cells.z, false);
    if (y.image == kNoImage || z.image == kNoImage) continue;
    const uint first = numberOf(cells, ivec3(0, y.cell, z.cell));
    const uint end = args.bodyFirsts.at[first + x.end];
    for (uint k = args.bodyFirsts.at[first + x.begin]; k < end; ++k) {
      const vec4 point = args.bodyPoints.at[k];
      const vec3 offset = here - point.xyz;
      if (dot(offset, offset) < support * support) meetPoint(bodyMeeting(pose, place, offset, support, point.w), k);
    }
  }
}

#endif
