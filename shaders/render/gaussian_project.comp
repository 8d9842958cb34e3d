#version 460
#extension GL_GOOGLE_include_directive : require
// Projects each Gaussian to the picture (elliptical weighted average: Zwicker et al. 2001, section 5; Kerbl et al.
// 2023, section 4), where its point is now, and evaluates its colour for the direction of view. The covariance on
// screen is that of two rows of a matrix, r0 and r1, so its determinant is a sum of squares, without cancellation.
#include "shaders/lib/index.glsl"
#include "shaders/render/frame_block.glsl"
#include "shaders/render/shown.glsl"
#include "shaders/render/view.glsl"
#include "shaders/shared/gaussians.h"

layout(push_constant, scalar) uniform Push { GaussianProjectArgs args; };

const mat3 kNoTurn = mat3(1);

// Rotates the axes by a unit quaternion.
mat3 rotationOf(vec4 q) {
  const vec3 d = 2 * q.xyz;
  const float xx = d.x * q.x, yy = d.y * q.y, zz = d.z * q.z, xy = d.x * q.y, xz = d.x * q.z, yz = d.y * q.z;
  const vec3 w = d * q.w;
  return mat3(1 - yy - zz, xy + w.z, xz - w.y, xy - w.z, 1 - xx - zz, yz + w.x, xz + w.y, yz - w.x, 1 - xx - yy);
}

// Unit, across `normal`.
vec3 anyAcross(vec3 normal) {
  return normalize(cross(normal, abs(normal.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0)));
}

mat3 shortestTurn(vec3 from, vec3 to) {
  const vec3 v = cross(from, to);
  const float c = dot(from, to);
  if (c < -0.999) return kNoTurn;
  return mat3(c, v.z, -v.y, -v.z, c, v.x, v.y, -v.x, c) + outerProduct(v, v) / (1 + c);
}

// How the surface has rotated: by its normal, and about it by the direction to another point.
mat3 turnOf(vec3 normal, vec3 normalNow, vec3 beside, vec3 besideNow) {
  if (normal == vec3(0) || normalNow == vec3(0)) return kNoTurn;
  const vec3 across = beside - dot(beside, normal) * normal;
  const vec3 acrossNow = besideNow - dot(besideNow, normalNow) * normalNow;
  // At the border of what was moved the other point has stayed, and shows no rotation.
  const float ratio = dot(besideNow, besideNow) / dot(beside, beside);
  const bool isSeen = dot(across, across) > 0.01 * dot(beside, beside) && ratio > 0.5 && ratio < 2 &&
                      dot(acrossNow, acrossNow) > 0.01 * dot(besideNow, besideNow);  // false for NaN
  if (!isSeen) return shortestTurn(normal, normalNow);
  const vec3 x = normalize(across), now = normalize(acrossNow);
  return mat3(now, cross(normalNow, now), normalNow) * transpose(mat3(x, cross(normal, x), normal));
}

// By what factor the surface around a point has grown: as a triangle with two others, if it kept its shape; else 1.
float growthOf(vec3 a, vec3 aNow, vec3 b, vec3 bNow) {
  const vec3 before = vec3(dot(a, a), dot(b, b), dot(a - b, a - b));
  const vec3 ratios = vec3(dot(aNow, aNow), dot(bNow, bNow), dot(aNow - bNow, aNow - bNow)) / before;
  const float mean = (ratios.x + ratios.y + ratios.z) / 3;
  if (!all(lessThan(abs(ratios - mean), vec3(kGrownShape * mean)))) return 1;  // also where it is not a number
  const float growth = sqrt(mean);
  return abs(growth - 1) > kMinGrowth ? growth : 1;
}

// The sum of the harmonics of degree 1 to 3 (engine/cloud/gaussian_harmonics.hpp).
vec3 harmonicsOf(uint gaussian, vec3 direction) {
  const float x = direction.x, y = direction.y, z = direction.z, xx = x * x, yy = y * y, zz = z * z;
  const float k1 = 0.4886025119, k2 = 1.0925484306, k33 = 0.5900435899, k31 = 0.4570457995, k3 = 1.4453057213;
  const float values[15] =
      float[15](-k1 * y, k1 * z, -k1 * x, k2 * x * y, -k2 * y * z, 0.3153915653 * (2 * zz - xx - yy), -k2 * x * z,
                0.5 * k2 * (xx - yy), -k33 * y * (3 * xx - yy), 2 * k3 * x * y * z, -k31 * y * (4 * zz - xx - yy),
                0.3731763326 * z * (2 * zz - 3 * xx - 3 * yy), -k31 * x * (4 * zz - xx - yy), k3 * z * (xx - yy),
                -k33 * x * (xx - 3 * yy));
  const uint first = gaussian * ((3 * args.harmonicCount + 1) / 2);
  vec3 sum = vec3(0);
  for (uint k = 0; k < args.harmonicCount; ++k) {
    vec3 color;
    for (uint c = 0; c < 3; ++c) {
      const uint at = 3 * k + c;
      const vec2 both = unpackHalf2x16(args.harmonics.at[first + at / 2]);
      color[c] = at % 2 == 0 ? both.x : both.y;
    }
    sum += values[k] * color;
  }
  return sum;
}

struct Placed {
  vec3 center;
  mat3 axes;  // times the standard deviations
  float opacity;
  vec3 color;
};

bool isGone(uint point) { return floatBitsToUint(args.now.positions.at[point].w) == kEmptySlot; }

vec3 paint(uint point) {
  const bool hasColors = (frame.shown & kShownColors) != 0;
  return unpackUnorm4x8(paintOf(hasColors ? args.now.colors.at[point] : kUnpainted)).rgb;
}

// A point that was added after loading.
bool placeNew(uint point, out Placed placed) {
  if (isGone(point) || isHidden(point)) return false;
  const vec3 normal = args.now.normals.at[point].xyz;
  const vec2 size = args.spacing * vec2(kNewGaussianWidth, kNewGaussianHeight);
  const vec3 x = normal == vec3(0) ? vec3(1, 0, 0) : anyAcross(normal);
  const vec3 z = normal == vec3(0) ? vec3(0, 0, 1) : normal;
  placed = Placed(args.now.positions.at[point].xyz,
                  mat3(size.x * x, size.x * cross(z, x), (normal == vec3(0) ? size.x : size.y) * z),
                  kNewGaussianOpacity, tinted(point, paint(point)));
  return true;
}

bool place(uint i, RenderView view, out Placed placed) {
  const uint owner = args.gaussians.at[i].owner, point = owner & ~kFarOwner;
  placed.opacity = args.gaussians.at[i].opacity;
  placed.center = args.gaussians.at[i].center;
  placed.color = args.gaussians.at[i].color;
  if (owner != kNoOwner && (isGone(point) || isHidden(point))) return false;
  mat3 turn = kNoTurn;
  float growth = 1;
  if ((owner & kFarOwner) == 0) {
    const uint beside = args.gaussians.at[i].beside;
    const vec3 from = args.loaded.positions.at[point].xyz, to = args.now.positions.at[point].xyz;
    const vec3 normal = args.loaded.normals.at[point].xyz, normalNow = args.now.normals.at[point].xyz;
    const vec3 besideFrom = beside == kNoOwner ? vec3(0) : args.loaded.positions.at[beside].xyz - from;
    const vec3 besideTo = beside == kNoOwner ? vec3(0) : args.now.positions.at[beside].xyz - to;
    const uint across = args.gaussians.at[i].across;
    if (across != kNoOwner && besideFrom != besideTo)
      growth = growthOf(besideFrom, besideTo, args.loaded.positions.at[across].xyz - from,
                        args.now.positions.at[across].xyz - to);
    if (normal != normalNow || (from != to && besideFrom != besideTo))
      turn = turnOf(normal, normalNow, besideFrom, besideTo / growth);
    if (from != to || turn != kNoTurn || growth != 1) placed.center = to + growth * (turn * (placed.center - from));
    const bool hasColors = (frame.shown & kShownColors) != 0;
    if (hasColors && args.now.colors.at[point] != args.loaded.colors.at[point]) placed.color = paint(point);
  }
  if (args.harmonicCount > 0) {
    const vec3 sight = view.isOrthographic != 0 ? view.forward : normalize(placed.center - view.eye);
    placed.color += harmonicsOf(i, sight * turn);  // in the axes of the file: the inverse of a rotation
  }
  if ((owner & kFarOwner) == 0) placed.color = tinted(point, placed.color);
  const mat3 axes = turn * rotationOf(args.gaussians.at[i].rotation);
  const vec3 scale = growth * args.gaussians.at[i].scale;
  placed.axes = mat3(scale.x * axes[0], scale.y * axes[1], scale.z * axes[2]);
  return true;
}

bool project(RenderView view, Placed g, out ProjectedGaussian seen) {
  if (!(g.opacity > kGaussianFaintest)) return false;
  const vec3 p = toEye(view, g.center - view.eye);
  if (!(p.z >= view.nearDepth && p.z > 0)) return false;
  const vec2 size = vec2(view.size_px) / float(view.supersample), middle = view.center_px / float(view.supersample);
  const float focal = view.focal_px / float(view.supersample);
  const mat3 inEye = mat3(toEye(view, g.axes[0]), toEye(view, g.axes[1]), toEye(view, g.axes[2]));
  const vec3 x = vec3(inEye[0].x, inEye[1].x, inEye[2].x), y = vec3(inEye[0].y, inEye[1].y, inEye[2].y);
  const vec3 z = vec3(inEye[0].z, inEye[1].z, inEye[2].z);
  vec3 r0 = focal * x, r1 = -focal * y;
  if (view.isOrthographic == 0) {
    const vec2 low = -(middle + kGaussianBeside * size) / focal;
    const vec2 high = (size - middle + kGaussianBeside * size) / focal;
    const vec2 at = clamp(vec2(p.x, -p.y) / p.z, low, high);
    r0 = (r0 - focal * at.x * z) / p.z;
    r1 = (r1 - focal * at.y * z) / p.z;
  }
  seen.center_px = middle + focal / divisorAt(view, p.z) * vec2(p.x, -p.y);
  const float a = dot(r0, r0) + kGaussianLowPass, b = dot(r0, r1), c = dot(r1, r1) + kGaussianLowPass;
  const vec3 both = cross(r0, r1);
  const float determinant = dot(both, both) + kGaussianLowPass * (a + c - kGaussianLowPass);
  if (!(determinant < kGaussianLargest && a < kGaussianLargest && c < kGaussianLargest)) return false;
  seen.reach_px = sqrt(squaredReach(g.opacity) * vec2(a, c));
  // As pixel centres see it.
  if (any(lessThan(seen.center_px + seen.reach_px, vec2(0.5)))) return false;
  if (any(greaterThan(seen.center_px - seen.reach_px, size - 0.5))) return false;
  seen.shape = vec3(sqrt(c / determinant), b / c, inversesqrt(c));
  seen.opacity = g.opacity;
  seen.depth = p.z;
  seen.slope = vec2(seen.shape.x * dot(z, r0 - seen.shape.y * r1), seen.shape.z * dot(z, r1));
  const vec3 color = clamp(g.color, 0, 1000);
  seen.redGreen = packHalf2x16(color.rg);
  seen.blue = packHalf2x16(vec2(color.b, 0));
  return true;
}

void main() {
  const uint i = threadIndex();
  if (i >= args.count) return;
  const RenderView view = frame.view;
  Placed placed;
  ProjectedGaussian seen;
  const bool isPlaced =
      i < args.fileCount ? place(i, view, placed) : placeNew(args.loadedPoints + i - args.fileCount, placed);
  const bool isSeen = isPlaced && project(view, placed, seen);
  if (isSeen) args.projected.at[i] = seen;
  args.keys.at[i] = isSeen ? floatBitsToUint(seen.depth) : kNotProjected;
  args.values.at[i] = i;
}
