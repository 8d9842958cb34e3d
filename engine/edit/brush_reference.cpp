#include "engine/edit/brush_reference.hpp"

#include <algorithm>

#include "engine/core/check.hpp"
#include "engine/core/point_state.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

namespace {

static_assert(static_cast<shared::uint>(BrushKind::push) == shared::kBrushPush);
static_assert(static_cast<shared::uint>(BrushKind::carve) == shared::kBrushCarve);
static_assert(static_cast<shared::uint>(BrushKind::inflate) == shared::kBrushInflate);
static_assert(static_cast<shared::uint>(BrushKind::smooth) == shared::kBrushSmooth);
static_assert(static_cast<shared::uint>(BrushKind::grab) == shared::kBrushGrab);
static_assert(static_cast<shared::uint>(BrushKind::paint) == shared::kBrushPaint);

static_assert(packedColor(kUnpainted) == shared::kUnpainted);

double longestMove(double support) { return static_cast<double>(shared::kLongestMove) * support; }

}  // namespace

shared::Brush sharedBrush(const BrushOptions& options, double support) {
  PALPATE_CHECK_LE(0.0, options.tau);
  PALPATE_CHECK_LE(0.0, options.beta);
  PALPATE_CHECK_LE(options.beta, 1.0);
  PALPATE_CHECK_LT(0.0, options.toolRadius);
  PALPATE_CHECK_LE(0.0, options.strength);
  PALPATE_CHECK_LE(options.strength, 1.0);
  PALPATE_CHECK_LE(options.falloff, kMostFalloff);
  PALPATE_CHECK_LT(0.0, support);
  return {.kind = static_cast<shared::uint>(options.kind),
          .falloff = options.falloff,
          .tau = static_cast<float>(options.tau),
          .beta = static_cast<float>(options.beta),
          .toolRadius = static_cast<float>(options.toolRadius),
          .strength = static_cast<float>(options.strength),
          .longestMove = static_cast<float>(longestMove(support)),
          .support = static_cast<float>(support),
          .color = packedColor(options.color)};
}

BrushTool::BrushTool(const BrushOptions& options, double support, const DVec3& hip, const DVec3& lastHip,
                     const DVec3& spring)
    : options_(options), support_(support), longestMove_(longestMove(support)) {
  const double depth = glm::length(spring);
  acts_ = depth > options.tau;
  if (!acts_) return;
  outward_ = spring / depth;
  const bool standsBefore = options.kind == BrushKind::push || options.kind == BrushKind::carve;
  center_ = hip + (standsBefore ? (options.tau + options.toolRadius) * outward_ : spring);
  const DVec3 motion = hip - lastHip;
  const double way = glm::length(motion);
  motion_ = way > longestMove_ ? motion * (longestMove_ / way) : motion;
}

double BrushTool::share(const DVec3& place) const {
  const double r = glm::distance(place, center_) / options_.toolRadius;
  const double base = 1 - r * r;
  if (!acts_ || !(base > 0)) return 0;
  double weight = 1;
  for (std::uint32_t k = 0; k < options_.falloff; ++k) weight *= base;
  return options_.strength * weight;
}

BrushTool::Point BrushTool::toBall(const DVec3& place, const DVec3& normal) const {
  const DVec3 fromCenter = place - center_;
  const double distance = glm::length(fromCenter), depth = options_.toolRadius - distance;
  if (!acts_ || !(depth > 0)) return {place};
  const bool atCenter = distance <= static_cast<double>(shared::kAtCenter) * options_.toolRadius;
  const DVec3 away = atCenter ? -outward_ : fromCenter / distance;
  const bool carves = options_.kind == BrushKind::carve;
  if (carves && options_.strength == 0) return {place};
  if (carves && (glm::dot(normal, away) >= 0 || depth > static_cast<double>(shared::kCarveDepth) * support_))
    return {place, true};
  return {place + std::min((carves ? options_.strength : options_.beta) * depth, longestMove_) * away};
}

BrushTool::Point BrushTool::brushed(const DVec3& place, const DVec3& normal) const {
  if (options_.kind == BrushKind::push || options_.kind == BrushKind::carve) return toBall(place, normal);
  const double part = share(place);
  if (!(part > 0)) return {place};
  if (options_.kind == BrushKind::grab) return {place + part * motion_};
  if (options_.kind != BrushKind::inflate) return {place};
  const double step = part * static_cast<double>(shared::kInflateStep) * options_.toolRadius;
  return {place + std::min(step, longestMove_) * normal};
}

DVec3 BrushTool::smoothed(const DVec3& place, const SurfaceSample& surface) const {
  if (!surface.defined) return place;
  return place - std::clamp(share(place) * surface.distance, -longestMove_, longestMove_) * surface.normal;
}

std::uint32_t BrushTool::painted(const DVec3& place, std::uint32_t color) const {
  const double part = share(place);
  if (options_.kind != BrushKind::paint || !(part > 0)) return color;
  auto channels = unpackedColor(color == 0 ? shared::kUnpainted : color);
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const int gap = options_.color[k] - channels[k], size = std::abs(gap);
    // A level at least, so that the colour arrives.
    const int move = std::min(size, std::max(1, static_cast<int>(part * size + 0.5)));
    channels[k] = static_cast<std::uint8_t>(channels[k] + (gap < 0 ? -move : move));
  }
  return packedColor(channels);
}

}  // namespace palpate
