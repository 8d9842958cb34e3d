// What a pixel of a depth image says of the surface that it sees: place, normal and how far to trust them. The normal
// is that of the plane which fits the depths of a square of pixels best by least squares; in the inverse of depth that
// is linear, since the image of a plane is (a square of 3 x 3 gives central differences). Depths beyond a jump belong
// to another surface and are left out. Who walks over the square: engine/motion/pixel_surface.cpp,
// shaders/motion/pixel_surface.comp.
#ifndef PALPATE_SHARED_DEPTH_IMAGE_H
#define PALPATE_SHARED_DEPTH_IMAGE_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Pixels to either side of the one whose plane is fitted, at most. Few are enough where noise is small for the width
// of a pixel; but at 1 m that of a structured-light camera is as large, and differences of neighbours say nothing of a
// normal.
const int kFitReach = 3;
// A slope is fitted over as few pixels as let it err by no more than this, as a tangent: 6 degrees.
const float kLargestSlopeError = 0.1f;
// The steepest slope, as a tangent to the image plane, that two pixels of one surface have between them.
const float kSteepestSlope = 4.0f;
// In deviations of the noise: depths that differ by more than this and the slope are a jump.
const float kJumpDeviations = 4.0f;
// In the same: a depth that lies farther off its own plane is that of no surface, as those between two are.
const float kOutlierDeviations = 3.0f;
// The least cosine between a surface's normal and the way to the camera: 78 degrees. Beyond it depth hardly says where
// the surface is.
const float kMinFacing = 0.2f;

// A camera without distortion; the middle of the first pixel is at (0, 0). Pixels.
PALPATE_STRUCT(Pinhole) {
  Real fx;
  Real fy;
  Real cx;
  Real cy;
};
PALPATE_SINGLE(Pinhole);

// The deviation of a measured depth: least + growth * (depth - from)^2, metres. Of structured light after Nguyen, Izadi
// and Lovell 2012 ("Modeling Kinect sensor noise for improved 3D reconstruction and tracking").
PALPATE_STRUCT(DepthNoise) {
  Real least;   // m
  Real growth;  // 1/m
  Real from;    // m
};
PALPATE_SINGLE(DepthNoise);

// What measures depth.
PALPATE_STRUCT(DepthSensor) {
  PALPATE_OF(Pinhole) camera;
  PALPATE_OF(DepthNoise) noise;
};
PALPATE_SINGLE(DepthSensor);

PALPATE_FORMULA Real depthDeviation(PALPATE_OF(DepthNoise) noise, Real depth) {
  const Real beyond = max(depth - noise.from, Real(0.0));
  return noise.least + noise.growth * beyond * beyond;
}

// The sum of x^2 over a full square of pixels: the variance of a fitted slope is that of a pixel over this.
PALPATE_FORMULA Real squaresWithin(Real reach) {
  const Real side = Real(2.0) * reach + Real(1.0);
  return side * side * (side * side - Real(1.0)) / Real(12.0);
}

// The variance of the slope between two pixels side by side, from noise.
PALPATE_FORMULA Real slopeVariance(PALPATE_OF(DepthSensor) sensor, Real depth) {
  const Real slope = depthDeviation(sensor.noise, depth) * min(sensor.camera.fx, sensor.camera.fy) / depth;
  return slope * slope;
}

// Pixels to either side that a plane is fitted to at a depth.
PALPATE_FORMULA int fitReach(PALPATE_OF(DepthSensor) sensor, Real depth) {
  const Real most = Real(kLargestSlopeError) * Real(kLargestSlopeError);
  const Real variance = slopeVariance(sensor, depth);
  int reach = 1;
  while (reach < kFitReach && variance > most * squaresWithin(Real(reach))) ++reach;
  return reach;
}

// From the camera through a pixel, to a depth of 1.
PALPATE_FORMULA PALPATE_VEC3 rayThrough(PALPATE_OF(Pinhole) camera, PALPATE_VEC2 pixel) {
  return PALPATE_VEC3((pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy, Real(1.0));
}

// In the camera's coordinates. Depth 0: no surface.
PALPATE_STRUCT(PixelSurface) {
  PALPATE_VEC3 normal;  // unit, to the camera
  Real depth;           // of the fitted plane at the pixel, m
};
PALPATE_SINGLE(PixelSurface);

// Sums over pixels about the one in the middle.
PALPATE_STRUCT(PlaneSums) {
  Real count;
  PALPATE_VEC2 offsets;   // sums of x, y
  PALPATE_VEC3 products;  // sums of x x, x y, y y
  Real rise;              // sum of q, the inverse depth less that in the middle
  PALPATE_VEC2 slopes;    // sums of x q, y q
};
PALPATE_SINGLE(PlaneSums);

PALPATE_FORMULA PALPATE_OF(PlaneSums) noPixels(Real zero) {
  PALPATE_OF(PlaneSums) sums;
  sums.count = zero;
  sums.offsets = PALPATE_VEC2(zero);
  sums.products = PALPATE_VEC3(zero);
  sums.rise = zero;
  sums.slopes = PALPATE_VEC2(zero);
  return sums;
}

// Adds a pixel at `offset` from the middle, where depth is measured and belongs to the same surface.
PALPATE_FORMULA void addPixel(PALPATE_INOUT(PALPATE_OF(PlaneSums)) sums, PALPATE_OF(DepthSensor) sensor, Real middle,
                              PALPATE_VEC2 offset, Real depth) {
  if (!(depth > Real(0.0))) return;
  const Real footprint = middle / min(sensor.camera.fx, sensor.camera.fy);
  const Real jump = Real(kSteepestSlope) * footprint * max(abs(offset.x), abs(offset.y)) +
                    Real(kJumpDeviations) * depthDeviation(sensor.noise, middle);
  if (abs(depth - middle) > jump) return;
  const Real q = (middle - depth) / (middle * depth);
  sums.count += Real(1.0);
  sums.offsets += offset;
  sums.products += PALPATE_VEC3(offset.x * offset.x, offset.x * offset.y, offset.y * offset.y);
  sums.rise += q;
  sums.slopes += q * offset;
}

// The surface that the sums about a pixel of depth `middle` show.
PALPATE_FORMULA PALPATE_OF(PixelSurface)
    surfaceOf(PALPATE_OF(PlaneSums) sums, PALPATE_OF(DepthSensor) sensor, PALPATE_VEC2 pixel, Real middle) {
  const PALPATE_OF(Pinhole) camera = sensor.camera;
  PALPATE_OF(PixelSurface) none;
  none.normal = PALPATE_VEC3(Real(0.0));
  none.depth = Real(0.0);
  // A corner of the square says where a plane lies; fewer pixels are no surface.
  const Real corner = Real(fitReach(sensor, middle)) + Real(1.0);
  if (sums.count < corner * corner) return none;
  const Real n = sums.count;
  const Real cxx = n * sums.products.x - sums.offsets.x * sums.offsets.x;
  const Real cxy = n * sums.products.y - sums.offsets.x * sums.offsets.y;
  const Real cyy = n * sums.products.z - sums.offsets.y * sums.offsets.y;
  const Real cxq = n * sums.slopes.x - sums.offsets.x * sums.rise;
  const Real cyq = n * sums.slopes.y - sums.offsets.y * sums.rise;
  const Real spread = cxx * cyy - cxy * cxy;
  if (!(spread > Real(0.5))) return none;
  const Real a = (cxq * cyy - cyq * cxy) / spread;
  const Real b = (cyq * cxx - cxq * cxy) / spread;
  const Real inverse = Real(1.0) / middle + (sums.rise - a * sums.offsets.x - b * sums.offsets.y) / n;
  if (!(inverse > Real(0.0))) return none;
  const Real depth = Real(1.0) / inverse;
  if (abs(depth - middle) > Real(kOutlierDeviations) * depthDeviation(sensor.noise, middle)) return none;
  // A plane m.p = 1 has the inverse depth m.ray, whose slopes are m.x / fx and m.y / fy.
  const PALPATE_VEC3 away =
      PALPATE_VEC3(a * camera.fx, b * camera.fy, inverse - a * (pixel.x - camera.cx) - b * (pixel.y - camera.cy));
  const PALPATE_VEC3 normal = -normalize(away);
  if (-dot(normal, normalize(rayThrough(camera, pixel))) < Real(kMinFacing)) return none;
  PALPATE_OF(PixelSurface) surface;
  surface.normal = normal;
  surface.depth = depth;
  return surface;
}

PALPATE_SHARED_END
#endif
