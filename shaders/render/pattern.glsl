// A pattern of 4 x 4 pixels by which neighbours sample different directions, the same in every picture, and the shares
// of 5 x 5 pixels in which each place of the pattern counts the same, so that their mean is free of it.
#ifndef PALPATE_RENDER_PATTERN_GLSL
#define PALPATE_RENDER_PATTERN_GLSL

// 0 to 15, each once in 4 x 4 pixels (Bayer 1973).
uint rankOf(ivec2 pixel) {
  const uint x = uint(pixel.x ^ pixel.y), y = uint(pixel.y);
  return (x & 1) << 3 | (y & 1) << 2 | (x & 2) | (y & 2) >> 1;
}
// Pixels two to the left and two to the right have the same place in the pattern. The shares add up to 16.
float shareOf(ivec2 away) { return (abs(away.x) == 2 ? 0.5 : 1.0) * (abs(away.y) == 2 ? 0.5 : 1.0); }

#endif
