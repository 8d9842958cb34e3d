#ifndef PALPATE_TESTS_BRUSH_PROBE_H
#define PALPATE_TESTS_BRUSH_PROBE_H
#include "shaders/shared/look_ahead.h"

PALPATE_SHARED_BEGIN

// Arguments and results of the functions of shaders/shared/brush.h.
struct BrushQuestion {
  Brush brush;
  BrushTool tool;
  vec3 position;
  vec3 normal;
  vec3 foundPosition;
  vec3 foundNormal;
  float room;
  float lock;
  uint color;
};
PALPATE_SIZE(BrushQuestion, 244);

struct BrushAnswer {
  Brushed brushed;
  uint painted;
  vec3 smoothed;
  MeasuredPoint measured;
  float free;    // model units, from the position as found, in sight of the question's
  float beside;  // the same beside a blocked point there, found at the origin
};
PALPATE_SIZE(BrushAnswer, 60);

struct BrushProbeArgs {
  PALPATE_ADDRESS(BrushQuestions) questions;
  PALPATE_ADDRESS(BrushAnswers) answers;
  uint count;
  float signedDistance;
};
PALPATE_SIZE(BrushProbeArgs, 24);

PALPATE_FUNCTION BrushAnswer answerTo(BrushQuestion q, float signedDistance) {
  FoundPoint found;
  found.position = q.foundPosition;
  found.normal = q.foundNormal;
  found.room = q.room;
  found.lock = q.lock;
  BrushAnswer answer;
  answer.brushed = brushed(q.brush, q.tool, q.position, q.normal, found);
  answer.painted = painted(q.brush, q.tool, q.position, found, q.color);
  answer.smoothed = smoothed(q.brush, q.tool, q.position, found, signedDistance, q.normal);
  answer.measured = measured(q.brush, q.tool, found);
  SeenPoint seen;
  seen.offset = q.position - q.foundPosition;
  seen.normal = q.normal;
  seen.moves = q.color % 2u != 0u;
  const Path path = pathOf(q.brush, q.tool, q.foundPosition, found, 0.5f);
  answer.free = freeUntil(q.brush, q.tool, path, seen, 1.0f);
  answer.beside = freeBeside(q.brush, path, seen.offset, -q.position, q.foundNormal, 50.0f);
  return answer;
}

PALPATE_SHARED_END
#endif
