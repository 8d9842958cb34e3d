// What a pixel of a depth image measures of its surface: position, normal and accuracy. The normal is that of the plane
// that fits the depths of a square of pixels best by least squares; in inverse depth the fit is linear, since the image
// of a plane is (a square of 3 x 3 gives central differences). Depths beyond a jump belong to another surface and are
// left out. The loops over the square are in engine/motion/fusion.cpp and shaders/motion/pixel_surface.comp.
#ifndef PALPATE_SHARED_DEPTH_IMAGE_H
#define PALPATE_SHARED_DEPTH_IMAGE_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Maximum pixels to either side of the one whose plane is fitted. Few are enough where noise is small relative to the
// width of a pixel; but at 1 m the noise of a structured-light camera is as large, and differences of neighbouring
// pixels do not determine a normal.
const int kFitReach = 3;
// A slope is fitted over the fewest pixels with which its error, as a tangent, is at most this: 6 degrees.
const float kLargestSlopeError = 0.1f;
// Maximum slope, as a tangent to the image plane, between two pixels of one surface.
const float kSteepestSlope = 4.0f;
// In standard deviations of the noise: depths that differ by more than this and the slope are a jump.
const float kJumpDeviations = 4.0f;
// In the same unit: a depth farther than this from its own plane is not on a surface, like depths between two surfaces.
const float kOutlierDeviations = 3.0f;
// Minimum cosine between a surface's normal and the direction to the camera: 78 degrees. Beyond it depth hardly
// determines the position of the surface.
const float kMinFacing = 0.2f;

// A camera without distortion; the middle of the first pixel is at (0, 0). Pixels.
PALPATE_STRUCT(Pinhole) {
  Real fx;
  Real fy;
  Real cx;
  Real cy;
};
PALPATE_SINGLE(Pinhole);

// Standard deviation of a measured depth: least + growth * (depth - from)^2, metres. For structured light after Nguyen,
// Izadi and Lovell 2012 ("Modeling Kinect sensor noise for improved 3D reconstruction and tracking").
PALPATE_STRUCT(DepthNoise) {
  Real least;   // m
  Real growth;  // 1/m
  Real from;    // m
};
PALPATE_SINGLE(DepthNoise);

// A depth sensor.
PALPATE_STRUCT(DepthSensor) {
  PALPATE_OF(Pinhole) camera;
  PALPATE_OF(DepthNoise) noise;
};
PALPATE_SINGLE(DepthSensor);

PALPATE_FORMULA Real depthDeviation(PALPATE_OF(DepthNoise) noise, Real depth) {
  const Real beyond = max(depth - noise.from, Real(0.0));
  return noise.least + noise.growth * beyond * beyond;
}

// The sum of x^2 over a full square of pixels: the variance of a fitted slope is that of a pixel divided by this.
PALPATE_FORMULA Real squaresWithin(Real reach) {
  const Real side = Real(2.0) * reach + Real(1.0);
  return side * side * (side * side - Real(1.0)) / Real(12.0);
}

// The variance of the slope between two adjacent pixels, from noise.
PALPATE_FORMULA Real slopeVariance(PALPATE_OF(DepthSensor) sensor, Real depth) {
  const Real slope = depthDeviation(sensor.noise, depth) * min(sensor.camera.fx, sensor.camera.fy) / depth;
  return slope * slope;
}

// Pixels to either side for the plane fit at a depth.
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

// Sums over the pixels around the middle one.
PALPATE_STRUCT(PlaneSums) {
  Real count;
  PALPATE_VEC2 offsets;   // sums of x, y
  PALPATE_VEC3 products;  // sums of x x, x y, y y
  Real rise;              // sum of q, the inverse depth minus that in the middle
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

// Adds a pixel at `offset` from the middle, if its depth is measured and belongs to the same surface.
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

// The surface at a pixel of depth `middle`, from the sums around it.
PALPATE_FORMULA PALPATE_OF(PixelSurface)
    surfaceOf(PALPATE_OF(PlaneSums) sums, PALPATE_OF(DepthSensor) sensor, PALPATE_VEC2 pixel, Real middle) {
  const PALPATE_OF(Pinhole) camera = sensor.camera;
  PALPATE_OF(PixelSurface) none;
  none.normal = PALPATE_VEC3(Real(0.0));
  none.depth = Real(0.0);
  // A corner of the square is enough for a plane; fewer pixels do not define a surface.
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
