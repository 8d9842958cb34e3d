// Passes that draw water: a ball for each particle, smoothed on screen into one surface (van der Laan et al. 2009,
// "Screen space fluid rendering with curvature flow"; Truong and Yuksel 2018, "A narrow-range filter for screen-space
// fluid rendering"), with the thickness of the water behind it. One value for each pixel of the picture.
#ifndef PALPATE_SHARED_WATER_H
#define PALPATE_SHARED_WATER_H
#include "shaders/shared/render.h"

PALPATE_SHARED_BEGIN

// Invocations that share the pixels of a ball.
const uint kWaterWalkers = 16;
// Largest square of pixels that they walk: a ball so close covers the picture with others.
const uint kWidestBall_px = 960;
// Minimum radius of a ball, pixels: it covers the centre of a pixel wherever it lies.
const float kMinBall_px = 0.71f;
// Standard deviations of the smoothing, radii of balls: of the depth; of thickness and cover it is half of that. Larger
// flattens waves, smaller shows the particles.
const float kWaterSmooth = 1.5f;
// In radii: a step of the depth by more than this divides two parts of the water, as a drop before the rest.
const float kWaterBand = 4;
// In radii: how far behind a pixel its farther neighbours count, so that rims are round.
const float kWaterRim = 1;
// Radius of the window of the smoothing, standard deviations and pixels: the trip count is twice this.
const float kWaterWindow = 2;
const uint kMaxWaterReach_px = 48;
// In radii: how much nearer and farther than the front of its balls the surface may be, so that it passes them.
const float kWaterNearer = 0.5f;
const float kWaterFarther = 2;
// Radius of the last, square window, which removes the streaks that rows and columns leave: of a ball, and pixels.
const float kWaterTidy = 0.4f;
const uint kMaxWaterTidy_px = 6;
// Light that one longest side of the model absorbs: exponents of red, green and blue (Beer and Lambert).
const vec3 kWaterAbsorption = vec3(9.0f, 3.0f, 1.3f);
// Reflectance at right angles (Schlick 1994), by an index of refraction of 1.33.
const float kWaterReflectance = 0.02f;
// Sideways shift of what is seen through water, of its thickness, by the slope of its surface: (1.33 - 1) / 1.33.
const float kWaterBend = 0.25f;
const float kMaxWaterBend_px = 64;

struct WaterArgs {
  PALPATE_ADDRESS(Uints) source;  // of what is not water, as in ShadeArgs, like the depth
  PALPATE_ADDRESS(Uints) depth;
  PALPATE_ADDRESS(Vec4s) positions;
  PALPATE_ADDRESS(Uints) fronts;  // bits of the depth of the nearest ball, kNoDepth: none
  PALPATE_ADDRESS(Uints) sums;    // thickness of all balls before what is not water, in 1 / unitsInLength
  PALPATE_ADDRESS(UVec2s)
  across;  // smoothed along rows, and at last in squares: bits of the depth; thickness and cover as two half floats
  PALPATE_ADDRESS(UVec2s) smoothed;  // and along columns
  PALPATE_ADDRESS(UVec2s) behind;    // one per sample: light of what is not water
  PALPATE_ADDRESS(UVec2s) shaded;    // out, one per sample: light of the picture
  PALPATE_ADDRESS(Uints) surface;    // out, one per sample: bits of the depth of the visible surface
  uint count;                        // the first points of the cloud are the particles
  float radius;                      // of their balls, model units
  float share;                       // of a ball that is its particle's own: balls overlap
  float unitsInLength;               // fixed-point unit of `sums`, in one model unit
  float side;                        // longest side of the model, model units: unit of thickness
  uint unused;
};
PALPATE_SIZE(WaterArgs, 104);

PALPATE_SHARED_END
#endif
