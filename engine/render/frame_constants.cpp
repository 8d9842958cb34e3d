#include "engine/render/frame_constants.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "shaders/shared/brush.h"

namespace palpate {

namespace {

// RGBA8 of points without colour, by material.
constexpr std::array<std::uint32_t, 6> kBaseColors{shared::kUnpainted,
                                                   packedColor({173, 170, 164, 255}),
                                                   packedColor({229, 226, 221, 255}),
                                                   packedColor({188, 188, 189, 255}),
                                                   shared::kUnpainted,
                                                   packedColor({70, 128, 160, 255})};
const Vec3 kBackgroundTop(0.020f, 0.024f, 0.033f);
const Vec3 kBackgroundBottom(0.115f, 0.125f, 0.145f);
constexpr double kDiscThickness = 0.12;  // of its radius
constexpr double kOcclusionRadius =
    0.07;  // of the model's longest side; larger darkens wide hollows, smaller only creases
constexpr double kUsualRadius_spacings = 1.95;  // if discs have their own radii
constexpr double kHoleReach = 2.0;              // in usual radii, across a gap from any position in it
constexpr double kTriangleOff = 0.25;           // of a cell: upper bound of the distance from flat to curved surface
// Assumed maximum of triangles of equal depth in one sample. Usually a few meet there; more do only if a whole mesh
// covers a few samples, and their sums may then be wrong.
constexpr std::uint32_t kTrianglesInSample = 1u << 17;

float linearFromSrgb(std::uint8_t encoded) {
  const double x = encoded / 255.0;
  return static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

Vec3 linearColor(std::uint32_t rgba) {
  const std::array<std::uint8_t, 4> color = unpackedColor(rgba);
  return {linearFromSrgb(color[0]), linearFromSrgb(color[1]), linearFromSrgb(color[2])};
}

shared::RenderView viewOf(const Camera& camera, const FrameSize& size) {
  const UVec2 size_px(size.width * size.supersample, size.height * size.supersample);
  const Camera::Axes axes = camera.axes();
  return {.eye = Vec3(camera.eye),
          .focal_px = static_cast<float>(camera.focal_px(size_px.y)),
          .right = Vec3(axes.right),
          .nearDepth = static_cast<float>(camera.nearDepth),
          .up = Vec3(axes.up),
          .supersample = size.supersample,
          .forward = Vec3(axes.forward),
          .isOrthographic = camera.isOrthographic(),
          .center_px = Vec2(camera.center * DVec2(size_px)),
          .size_px = size_px};
}

// White, or black on a light background and on a transparent one, as most pages are white.
Vec3 barColorOn(const FrameOptions& options) {
  constexpr int kLight = 130;
  const std::array<std::uint8_t, 3> background = options.background.value_or(std::array<std::uint8_t, 3>{});
  const int level = (30 * background[0] + 59 * background[1] + 11 * background[2]) / 100;
  return Vec3(options.transparent || level > kLight ? 0.06f : 0.94f);
}

shared::RenderOverlays overlaysOf(const FrameOptions& options) {
  const Overlays& wanted = options.overlays;
  shared::RenderOverlays overlays{};
  if (wanted.hip) {
    overlays.ballCenter = Vec3(wanted.hip->center);
    overlays.ballRadius = static_cast<float>(wanted.hip->radius);
  }
  if (wanted.proxy) {
    overlays.discCenter = Vec3(wanted.proxy->center);
    overlays.discRadius = static_cast<float>(wanted.proxy->radius);
    overlays.discNormal = Vec3(wanted.proxy->normal);
    overlays.discHalfThickness = static_cast<float>(0.5 * kDiscThickness * wanted.proxy->radius);
  }
  const double length = wanted.force ? glm::length(wanted.force->along) : 0.0;
  if (length > 0) {
    overlays.arrowFrom = Vec3(wanted.force->from);
    overlays.arrowRadius = static_cast<float>(wanted.force->shaftRadius);
    overlays.arrowDirection = Vec3(wanted.force->along / length);
    overlays.arrowLength = static_cast<float>(length);
  }
  if (wanted.brush) {
    overlays.brushCenter = Vec3(wanted.brush->center);
    overlays.brushRadius = static_cast<float>(wanted.brush->radius);
  }
  const double bar = wanted.scale ? glm::length(wanted.scale->along) : 0.0;
  if (bar > 0) {
    overlays.barFrom = Vec3(wanted.scale->from);
    overlays.barRadius = static_cast<float>(wanted.scale->radius);
    overlays.barDirection = Vec3(wanted.scale->along / bar);
    overlays.barLength = static_cast<float>(bar);
    overlays.barColor = barColorOn(options);
  }
  return overlays;
}

double usualRadius(const DrawnCloud& cloud, const FrameOptions& options) {
  return options.splatRadius > 0 ? options.splatRadius : kUsualRadius_spacings * cloud.spacing();
}

// Discs finer than a sample are drawn as large as one, and the gaps between them grow likewise.
double usualDrawnRadius(const Drawn& drawn, const Camera& camera, std::uint32_t height_px) {
  if (drawn.everyPoint) return drawn.usualRadius;
  const double middle = glm::distance(camera.eye, drawn.bounds.center());
  return std::max(drawn.usualRadius, shared::kFinestSplat * camera.divisorAt(middle) / camera.focal_px(height_px));
}

// Bounding box of a ball on screen, pixels: left, top, right, bottom. The whole screen if the ball comes too close to
// the eye.
std::array<DVec2, 2> boxOf(const Overlays::Ball& ball, const Camera& camera, const DVec2& size_px) {
  const Camera::Axes axes = camera.axes();
  const DVec3 offset = ball.center - camera.eye;
  const double depth = glm::dot(offset, axes.forward), nearest = depth - ball.radius;
  if (!(nearest > camera.nearDepth)) return {DVec2(0), size_px};
  const double focal_px = camera.focal_px(size_px.y);
  const DVec2 aside(glm::dot(offset, axes.right), -glm::dot(offset, axes.up));
  // Upper bound: every part of the ball at its smallest depth and largest offset.
  constexpr double kSlack_px = 4;  // lines have a minimum width
  const double reach_px = focal_px * (ball.radius + glm::length(aside)) / camera.divisorAt(nearest) -
                          focal_px * glm::length(aside) / camera.divisorAt(depth) + kSlack_px;
  const DVec2 at_px = camera.center * size_px + focal_px / camera.divisorAt(depth) * aside;
  return {at_px - reach_px, at_px + reach_px};
}

}  // namespace

PixelRectangle overlayRectangle(const Overlays& overlays, const Camera& camera, const UVec2& size_px) {
  DVec2 low(std::numeric_limits<double>::infinity()), high(-low);
  const auto add = [&](const DVec3& center, double radius) {
    const auto [first, last] = boxOf({center, radius}, camera, DVec2(size_px));
    low = glm::min(low, first);
    high = glm::max(high, last);
  };
  constexpr double kWidestPart = 4;   // of an arrow or a bar, in their radii (shaders/render/overlays.glsl)
  constexpr double kThickDisc = 1.5;  // radius of the ball around a disc, in radii of the disc
  if (overlays.hip) add(overlays.hip->center, overlays.hip->radius);
  if (overlays.proxy) add(overlays.proxy->center, kThickDisc * overlays.proxy->radius);
  if (overlays.brush) add(overlays.brush->center, overlays.brush->radius);
  for (const double end : {0.0, 1.0}) {
    if (overlays.force)
      add(overlays.force->from + end * overlays.force->along, kWidestPart * overlays.force->shaftRadius);
    if (overlays.scale) add(overlays.scale->from + end * overlays.scale->along, kWidestPart * overlays.scale->radius);
  }
  low = glm::clamp(glm::floor(low), DVec2(0), DVec2(size_px));
  high = glm::clamp(glm::ceil(high), DVec2(0), DVec2(size_px));
  if (!(low.x < high.x && low.y < high.y)) return {};
  return {UVec2(low), UVec2(high - low)};
}

Drawn drawn(const DrawnCloud& cloud, const FrameOptions& options) {
  Drawn drawn{.bounds = cloud.bounds(),
              .count = cloud.count(),
              .hasColors = false,
              .widest = 0,
              .splatRadius = options.splatRadius,
              .widestSplat = options.splatRadius > 0 ? options.splatRadius : cloud.largestRadius(),
              .usualRadius = usualRadius(cloud, options),
              .spacing = cloud.spacing(),
              .closeHoles = options.closeHoles,
              .inSample = cloud.count(),
              .everyPoint = options.everyPoint || options.raster == Raster::hardware};
  if (cloud.hasColors() && options.color != ColorBy(ColorSource::material)) drawn.shown |= shared::kShownColors;
  const auto show = [&](const Buffer* buffer, std::uint32_t what, DeviceAddress& address) {
    if (!buffer) return;
    drawn.shown |= what;
    address = buffer->address();
  };
  const DrawnAttributes& attributes = cloud.attributes();
  if (options.tintsSelected) {
    show(attributes.mask(MaskRole::selected), shared::kShownSelected, drawn.selected);
    show(attributes.lock(), shared::kShownLock, drawn.lock);
  }
  show(attributes.mask(MaskRole::hidden), shared::kShownHidden, drawn.hidden);
  if (std::holds_alternative<FieldColors>(options.color)) show(attributes.values(), shared::kShownField, drawn.values);
  if (showsWater(options)) drawn.firstDisc = drawn.count - std::min(drawn.count, options.particles.standing);
  drawn.hasColors = (drawn.shown & ~shared::kShownHidden) != 0;
  return drawn;
}

Drawn drawn(const DrawnMesh& mesh) {
  return {.bounds = mesh.bounds,
          .count = mesh.triangleCount,
          .hasColors = mesh.hasColors,
          .widest = std::sqrt(3.0) * mesh.cell,
          .splatRadius = 0,
          .widestSplat = 0,
          .usualRadius = kTriangleOff * mesh.cell,
          .spacing = mesh.cell,
          .closeHoles = false,
          .inSample = kTrianglesInSample,
          .everyPoint = true};
}

std::uint32_t tilesOf(const Drawn& drawn, const Camera& camera, std::uint32_t height_px) {
  const double nearest = std::max(depthRangeOf(camera, drawn.bounds).x, camera.nearDepth);
  const double side_px = drawn.widest * camera.focal_px(height_px) / camera.divisorAt(nearest) + 2;
  const double affordable = std::sqrt(double{shared::kMaxTriangleInvocations} / std::max(drawn.count, 1u));
  const double most = std::clamp(std::floor(affordable), 1.0, double{shared::kMaxTriangleTiles});
  return static_cast<std::uint32_t>(std::clamp(std::ceil(side_px / shared::kTriangleTile), 1.0, most));
}

shared::RenderFrame frameConstants(const Drawn& drawn, const Camera& camera, const FrameOptions& options,
                                   const FrameSize& size, std::uint32_t tiles) {
  const Bounds shown = options.shown.value_or(drawn.bounds);
  const DVec2 depths = depthRangeOf(camera, shown);
  const double usual = usualDrawnRadius(drawn, camera, size.height * size.supersample);
  const auto* const source = std::get_if<ColorSource>(&options.color);
  const FieldColors range = source ? FieldColors() : std::get<FieldColors>(options.color);
  const std::uint32_t baseColor = kBaseColors[static_cast<std::size_t>(options.light.material)];
  shared::RenderFrame frame{.view = viewOf(camera, size),
                            .overlays = overlaysOf(options),
                            .boundsMin = Vec3(shown.min),
                            .depthMin = static_cast<float>(std::max(depths.x, camera.nearDepth)),
                            .boundsMax = Vec3(shown.max),
                            .depthMax = static_cast<float>(depths.y),
                            .up = Vec3(options.up),
                            .splatRadius = static_cast<float>(drawn.splatRadius),
                            .widestSplat = static_cast<float>(drawn.widestSplat),
                            .everyPoint = drawn.everyPoint,
                            .usualRadius = static_cast<float>(usual),
                            .sumScale = 0,
                            .count = drawn.count,
                            .triangleTiles = tiles,
                            .imagePass = static_cast<std::uint32_t>(options.pass),
                            .colorBy = source ? static_cast<std::uint32_t>(*source) : shared::kColorByFile,
                            .hasColors = drawn.hasColors,
                            .baseColor = linearColor(baseColor),
                            .shown = drawn.shown,
                            .backgroundTop = kBackgroundTop,
                            .occlusionRadius = static_cast<float>(kOcclusionRadius * shown.longestSide()),
                            .backgroundBottom = kBackgroundBottom,
                            .holeReach_px = 0,
                            .smooth_px = std::min(options.smooth_px * size.supersample, shared::kMaxSmooth_px),
                            .selected = drawn.selected,
                            .hidden = drawn.hidden,
                            .lock = drawn.lock,
                            .values = drawn.values,
                            .lowValue = static_cast<float>(range.low),
                            .highValue = static_cast<float>(range.high),
                            .colorMap = static_cast<std::uint32_t>(options.colorMap),
                            .material = static_cast<std::uint32_t>(options.light.material),
                            .unpainted = baseColor,
                            .backgroundOpacity = options.transparent ? 0.f : 1.f,
                            .firstDisc = drawn.firstDisc,
                            .hidesBacks = options.hidesBacks};
  if (drawn.closeHoles) {
    const double radius_px = usual * frame.view.focal_px / camera.divisorAt(std::max(depths.x, camera.nearDepth));
    frame.holeReach_px = static_cast<std::uint32_t>(std::min(kHoleReach * radius_px, double{shared::kMaxHoleReach_px}));
  }
  // No sum may reach 2^31, even if all add up in one sample.
  const std::uint32_t each = 0x7FFFFFFFu / std::max(drawn.inSample, 1u);
  frame.sumScale = static_cast<float>(std::min(std::bit_floor(each), shared::kFinestSum));
  if (options.background)
    for (int k = 0; k < 3; ++k)
      frame.backgroundTop[k] = frame.backgroundBottom[k] =
          linearFromSrgb((*options.background)[static_cast<std::size_t>(k)]);
  if (options.transparent) frame.backgroundTop = frame.backgroundBottom = Vec3(0);
  return frame;
}

}  // namespace palpate
