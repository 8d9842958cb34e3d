// Colours for numbers, in pictures and in the legends beside them.
#ifndef PALPATE_SHARED_RAMP_H
#define PALPATE_SHARED_RAMP_H
#include "shaders/shared/types.h"

PALPATE_SHARED_BEGIN

// From deep blue over green to warm yellow for x from 0 to 1, with increasing brightness, sRGB.
PALPATE_FUNCTION vec3 rampColor(float x) {
  const vec3 a = vec3(0.10f, 0.13f, 0.38f), b = vec3(0.11f, 0.37f, 0.58f), c = vec3(0.16f, 0.60f, 0.55f);
  const vec3 d = vec3(0.58f, 0.78f, 0.40f), e = vec3(0.98f, 0.87f, 0.45f);
  const float place = 4.0f * clamp(x, 0.0f, 1.0f);
  if (place < 1.0f) return a + place * (b - a);
  if (place < 2.0f) return b + (place - 1.0f) * (c - b);
  if (place < 3.0f) return c + (place - 2.0f) * (d - c);
  return d + (place - 3.0f) * (e - d);
}

PALPATE_SHARED_END
#endif
