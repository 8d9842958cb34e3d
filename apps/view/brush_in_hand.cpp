#include "apps/view/brush_in_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "haptics/session/settings.hpp"

namespace palpate {

namespace {

// Of a drag: pixels for twice the size, and for the whole range of strengths.
constexpr double kDouble_px = 120, kWholeStrength_px = 400;
constexpr int kRingCorners = 64;

std::string_view strengthName(const BrushSettings& brush) {
  return brushHas(brush.kind, shared::kUsesPushRate) ? "push_rate" : "strength";
}

}  // namespace

BrushSettings BrushInHand::brushFrom(const BrushSettings& chosen) const {
  BrushSettings brush = chosen;
  if (keys_.shift)
    brush.kind = BrushKind::smooth;
  else if (keys_.control)
    brush.kind = traitsOf(chosen.kind).inverse.value_or(chosen.kind);
  return brush;
}

std::string BrushInHand::wordsFor(const BrushSettings& chosen) const {
  if (!chosen.sculpts) return {};
  if (keys_.shift) return "smooth (Shift)";
  if (!keys_.control) return {};
  const BrushTraits& traits = traitsOf(chosen.kind);
  if (traits.inverse) return fmt::format("{} (Ctrl)", traitsOf(*traits.inverse).name);
  return fmt::format("{} has no inverse: {}", traits.name, traits.withoutInverse);
}

double& BrushInHand::valueOf(Drag what, BrushSettings& brush) {
  if (what == Drag::size) return brush.radius_mm;
  return brushHas(brush.kind, shared::kUsesPushRate) ? brush.pushRate : brush.strength;
}

// Of the last picture in which the depth was picked.
std::optional<BrushInHand::Spot> BrushInHand::spotUnder(const Pointed& at) {
  if (!(at.picked.depth > 0)) return std::nullopt;
  const Camera& camera = at.viewpoint.camera();
  return Spot{camera.unproject(at.picked.place_px, at.picked.depth, at.size_px),
              normalAt(at.picked, camera, at.size_px)};
}

void BrushInHand::begin(Drag what, const DVec2& place_px, const BrushSettings& brush, const Pointed& at) {
  BrushSettings had = brush;
  drag_ = {.what = what, .from_px = place_px, .had = valueOf(what, had), .spot = spotUnder(at)};
}

void BrushInHand::moveTo(const DVec2& place_px, BrushSettings& brush) const {
  const double way_px = place_px.x - drag_->from_px.x;
  const bool isSize = drag_->what == Drag::size;
  const Range& range = settingNamed<BrushConfig>(isSize ? "radius_mm" : strengthName(brush)).slider;
  const double value = isSize ? drag_->had * std::exp2(way_px / kDouble_px)
                              : drag_->had + (range.max - range.min) * way_px / kWholeStrength_px;
  valueOf(drag_->what, brush) = std::clamp(value, range.min, range.max);
}

void BrushInHand::giveUp(BrushSettings& brush) {
  if (drag_) valueOf(drag_->what, brush) = drag_->had;
  drag_.reset();
}

BrushHint BrushInHand::hint(const BrushSettings& chosen, const ViewSettings& view, const DVec2& cursor_px,
                            bool isOnModel, const Pointed& at) const {
  if (!at.session || !chosen.sculpts) return {};
  BrushHint hint{.kind = brushFrom(chosen).kind,
                 .ring_px = {},
                 .place_px = drag_ ? drag_->from_px : cursor_px,
                 .words = wordsFor(chosen)};
  BrushSettings brush = chosen;
  if (drag_ && drag_->what == Drag::size) hint.words = "size " + view.lengthText(brush.radius_mm, *at.session);
  if (drag_ && drag_->what == Drag::strength)
    hint.words = fmt::format("strength {:.2f}", valueOf(Drag::strength, brush));
  const std::optional<Spot> spot = drag_ ? drag_->spot : isOnModel ? spotUnder(at) : std::nullopt;
  if (!spot) return hint;
  const double radius = at.session->model().scale.toUnits(brush.radius_mm);
  const Frame3 frame = frameAround(spot->normal);
  for (int k = 0; k < kRingCorners; ++k) {
    const double angle = 2 * std::numbers::pi * k / kRingCorners;
    const DVec3 corner = spot->place + radius * (std::cos(angle) * frame.u + std::sin(angle) * frame.v);
    const auto corner_px = at.viewpoint.camera().project(corner, at.size_px);
    if (!corner_px) {  // behind the eye
      hint.ring_px.clear();
      return hint;
    }
    hint.ring_px.emplace_back(*corner_px);
  }
  return hint;
}

}  // namespace palpate
