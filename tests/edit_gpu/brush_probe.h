#ifndef PALPATE_TESTS_BRUSH_PROBE_H
#define PALPATE_TESTS_BRUSH_PROBE_H
#include "shaders/shared/brush.h"

PALPATE_SHARED_BEGIN

// Arguments and results of the functions of shaders/shared/brush.h.
struct BrushQuestion {
  Brush brush;
  BrushTool tool;
  vec3 position;
  vec3 normal;
  vec3 foundPosition;
  vec3 foundNormal;
  uint color;
};
PALPATE_SIZE(BrushQuestion, 212);

struct BrushAnswer {
  Brushed brushed;
  uint painted;
  vec3 smoothed;
  MeasuredPoint measured;
};
PALPATE_SIZE(BrushAnswer, 52);

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
  BrushAnswer answer;
  answer.brushed = brushed(q.brush, q.tool, q.position, q.normal, found);
  answer.painted = painted(q.brush, q.tool, q.position, q.foundNormal, q.color);
  answer.smoothed = smoothed(q.brush, q.tool, q.position, q.foundNormal, signedDistance, q.normal);
  answer.measured = measured(q.brush, q.tool, found);
  return answer;
}

PALPATE_SHARED_END
#endif
