#ifndef PALPATE_TESTS_SHARED_LAYOUT_H
#define PALPATE_TESTS_SHARED_LAYOUT_H
#include "shaders/shared/spatial_hash.h"

PALPATE_SHARED_BEGIN

// One of each type that both languages share, in an order that padding would break.
struct LayoutPattern {
  uint a;
  vec3 b;
  vec2 c;
  uint d;
  HashGrid grid;
  vec4 e;
  mat4 m;
};
PALPATE_SIZE(LayoutPattern, 4 + 12 + 8 + 4 + 24 + 16 + 64);

struct LayoutArgs {
  PALPATE_ADDRESS(LayoutPatterns) pattern;
  PALPATE_ADDRESS(Floats) numbers;
  uint scale;
  uint unused;
};
PALPATE_SIZE(LayoutArgs, 24);

PALPATE_SHARED_END
#endif
