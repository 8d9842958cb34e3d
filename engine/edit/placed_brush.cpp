#include "engine/edit/placed_brush.hpp"

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
static_assert(static_cast<shared::uint>(BrushKind::flatten) == shared::kBrushFlatten);

static_assert(packedColor(kUnpainted) == shared::kUnpainted);

// In the precision of `Real`.
template <class Real>
shared::BrushOf<Real> brushOf(const BrushOptions& options, double support) {
  return {.kind = static_cast<shared::uint>(options.kind),
          .falloff = options.falloff,
          .radius = static_cast<Real>(options.radius),
          .longestMove = static_cast<Real>(static_cast<double>(shared::kLongestMove) * support),
          .support = static_cast<Real>(support),
          .color = packedColor(options.color)};
}

}  // namespace

shared::Brush sharedBrush(const BrushOptions& options, double support) {
  PALPATE_CHECK_LE(0.0, options.tau);
  PALPATE_CHECK_LE(0.0, options.beta);
  PALPATE_CHECK_LE(options.beta, 1.0);
  PALPATE_CHECK_LT(0.0, options.radius);
  PALPATE_CHECK_LE(0.0, options.strength);
  PALPATE_CHECK_LE(options.strength, 1.0);
  PALPATE_CHECK_LE(options.falloff, kMostFalloff);
  PALPATE_CHECK_LT(0.0, support);
  return brushOf<float>(options, support);
}

shared::BrushTool sharedTool(const BrushStroke::Tool& tool) {
  return {.center = Vec3(tool.center),
          .acts = tool.acts,
          .outward = Vec3(tool.outward),
          .shaft = static_cast<float>(tool.shaft),
          .motion = Vec3(tool.motion),
          .share = static_cast<float>(tool.share),
          .middle = Vec3(tool.middle),
          .reach = static_cast<float>(tool.reach),
          .hand = Vec3(tool.hand),
          .hearing = static_cast<float>(tool.hearing),
          .height = static_cast<float>(tool.height),
          .stroke = tool.stroke,
          .sampling = tool.sampling,
          .unused = 0};
}

PlacedBrush::PlacedBrush(const BrushOptions& options, double support, const BrushStroke::Tool& tool)
    : brush_(brushOf<double>(options, support)), tool_(tool) {}

PlacedBrush::Point PlacedBrush::brushed(const DVec3& place, const DVec3& normal, const Found& found) const {
  const auto brushed = shared::brushed(brush_, tool_, place, normal, found);
  return {brushed.position, brushed.taken != 0};
}

shared::MeasuredPoint PlacedBrush::measured(const Found& found) const { return shared::measured(brush_, tool_, found); }

DVec3 PlacedBrush::smoothed(const DVec3& place, const Found& found, const SurfaceSample& surface) const {
  if (!surface.defined) return place;
  return shared::smoothed(brush_, tool_, place, found.normal, surface.distance, surface.normal);
}

std::uint32_t PlacedBrush::painted(const DVec3& place, const Found& found, std::uint32_t color) const {
  return shared::painted(brush_, tool_, place, found.normal, color);
}

}  // namespace palpate
