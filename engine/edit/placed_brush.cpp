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
          .tau = static_cast<Real>(options.tau),
          .beta = static_cast<Real>(options.beta),
          .radius = static_cast<Real>(options.radius),
          .strength = static_cast<Real>(options.strength),
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

// The ball that stands before the HIP is placed in one step, as it ever was; ballOf() takes two.
PlacedBrush::PlacedBrush(const BrushOptions& options, double support, const DVec3& hip, const DVec3& lastHip,
                         const DVec3& spring)
    : brush_(brushOf<double>(options, support)), ball_(shared::ballOf(brush_, hip, lastHip, spring, shared::kSliding)) {
  const bool standsBefore = options.kind == BrushKind::push || options.kind == BrushKind::carve;
  if (acts() && standsBefore) ball_.center = hip + (options.tau + options.radius) * ball_.outward;
}

PlacedBrush::Point PlacedBrush::brushed(const DVec3& place, const DVec3& normal) const {
  const auto brushed = shared::brushed(brush_, ball_, place, normal);
  return {brushed.position, brushed.taken != 0};
}

DVec3 PlacedBrush::smoothed(const DVec3& place, const SurfaceSample& surface) const {
  if (!surface.defined) return place;
  return shared::smoothed(brush_, ball_, place, surface.distance, surface.normal);
}

std::uint32_t PlacedBrush::painted(const DVec3& place, std::uint32_t color) const {
  return shared::painted(brush_, ball_, place, color);
}

}  // namespace palpate
