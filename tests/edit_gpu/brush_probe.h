#ifndef PALPATE_TESTS_BRUSH_PROBE_H
#define PALPATE_TESTS_BRUSH_PROBE_H
#include "shaders/shared/brush.h"

PALPATE_SHARED_BEGIN

// One question to the functions of shaders/shared/brush.h, and what they answer.
struct BrushQuestion {
  Brush brush;
  vec3 hip;
  vec3 lastHip;
  vec3 spring;
  uint touching;
  vec3 position;
  vec3 normal;
  uint color;
};
PALPATE_SIZE(BrushQuestion, 104);

struct BrushAnswer {
  Brushed brushed;
  uint painted;
  vec3 smoothed;
};
PALPATE_SIZE(BrushAnswer, 32);

struct BrushProbeArgs {
  PALPATE_ADDRESS(BrushQuestions) questions;
  PALPATE_ADDRESS(BrushAnswers) answers;
  uint count;
  float signedDistance;
};
PALPATE_SIZE(BrushProbeArgs, 24);

PALPATE_FUNCTION BrushAnswer answerTo(BrushQuestion q, float signedDistance) {
  const BrushBall ball = ballOf(q.brush, q.hip, q.lastHip, q.spring, q.touching);
  BrushAnswer answer;
  answer.brushed = brushed(q.brush, ball, q.position, q.normal);
  answer.painted = painted(q.brush, ball, q.position, q.color);
  answer.smoothed = smoothed(q.brush, ball, q.position, signedDistance, q.normal);
  return answer;
}

PALPATE_SHARED_END
#endif
