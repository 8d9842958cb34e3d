// The smallest of many squared distances, ascending, with twice the digits of a float.
#ifndef PALPATE_LIB_NEAREST_LIST_GLSL
#define PALPATE_LIB_NEAREST_LIST_GLSL

// Sums of two floats, the second of which is what the first one lacks (Dekker 1971, "A floating-point technique for
// extending the available precision"; Knuth's sum, without a comparison).
vec2 exactSum(float a, float b) {
  precise const float sum = a + b;
  precise const float part = sum - a;
  precise const float lost = (a - (sum - part)) + (b - part);
  return vec2(sum, lost);
}
vec2 plus(vec2 a, vec2 b) {
  const vec2 sum = exactSum(a.x, b.x);
  precise const float lost = sum.y + (a.y + b.y);
  return exactSum(sum.x, lost);
}
// fma() need not be fused: the factors are split in halves, whose products are exact (Veltkamp's split, as in Dekker).
vec2 square(vec2 a) {
  precise const float wide = 4097 * a.x;
  precise const float upper = wide - (wide - a.x);
  precise const float lower = a.x - upper;
  precise const float high = a.x * a.x;
  precise const float lost = ((upper * upper - high) + 2 * upper * lower) + lower * lower;
  precise const float all = lost + 2 * a.x * a.y;
  return exactSum(high, all);
}
vec2 root(vec2 a) {
  precise const float near = sqrt(a.x);
  if (!(near > 0)) return vec2(0);
  const vec2 squared = square(vec2(near, 0));
  precise const float lost = (((a.x - squared.x) - squared.y) + a.y) / (2 * near);
  return exactSum(near, lost);
}

vec2 squaredBetween(vec3 a, vec3 b) {
  vec2 squares = vec2(0);
  for (int k = 0; k < 3; ++k) squares = plus(squares, square(exactSum(a[k], -b[k])));
  return squares;
}

struct NearestList {
  vec2 squared[kMaxNearest];
  uint count;
};

bool isLess(vec2 a, vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

// `quick`: the squared distance between the positions, rounded.
void keepNearest(inout NearestList list, uint most, float quick, vec3 a, vec3 b) {
  const float kRounding = 1 + 1e-6;
  const bool isFull = list.count == most;
  if (isFull && quick > kRounding * list.squared[most - 1].x) return;
  const vec2 squared = squaredBetween(a, b);
  if (isFull && !isLess(squared, list.squared[most - 1])) return;
  uint at = min(list.count, most - 1);
  for (; at > 0 && isLess(squared, list.squared[at - 1]); --at) list.squared[at] = list.squared[at - 1];
  list.squared[at] = squared;
  list.count = min(list.count + 1, most);
}

#endif
