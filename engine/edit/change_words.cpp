#include "engine/edit/change_words.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "engine/core/counted.hpp"

namespace palpate {

namespace {

std::string whatOf(const PointStroke& stroke, const PointStates& present, const LayerAttributes& attributes) {
  const StrokeLayers& layers = attributes.strokeLayers();
  if (stroke.slide) return "strength of " + layers[stroke.slide->number].name;
  constexpr std::size_t kLooked = 4096;  // points, of which all others are alike
  const auto points = std::span<const PointState>(stroke.points).first(std::min(stroke.points.size(), kLooked));
  const auto differs = [&](auto PointState::*member) {
    return [&present, member](const PointState& other) { return other.*member != present[other.number].*member; };
  };
  const bool comeOrGo = std::ranges::any_of(points, differs(&PointState::gone));
  const auto hasCome = [&](const PointState& other) { return other.gone && !present[other.number].gone; };
  const bool isShaped = comeOrGo || std::ranges::any_of(points, differs(&PointState::position));
  std::string what = "stroke";
  if (!points.empty() && std::ranges::all_of(points, hasCome)) what = "new points";
  if (!isShaped && std::ranges::any_of(points, differs(&PointState::normal))) what = "normals";
  if (!isShaped && std::ranges::any_of(points, differs(&PointState::color))) what = "paint";
  if (isShaped && stroke.isGiven) what = "move";
  return stroke.layer ? what + " in " + layers[*stroke.layer].name : what;
}

std::string whatOf(const PresenceStroke& stroke, const PointStates& present, const LayerAttributes&) {
  return stroke.points.empty() || present[stroke.points.end() - 1].gone ? "removal" : "restored points";
}

std::string whatOf(const ShapeStroke&, const PointStates&, const LayerAttributes&) { return "stroke"; }

std::string whatOf(const AttributeChange& change, const PointStates&, const LayerAttributes& attributes) {
  constexpr std::array<const char*, kMaskRoles> kMasks{"selection", "hiding", "lock", "limit of the brushes"};
  if (const auto* const flip = std::get_if<MaskFlip>(&change)) return kMasks[static_cast<std::size_t>(flip->role)];
  if (const auto* const layer = std::get_if<StrokeLayerChange>(&change)) {
    const StrokeLayers& layers = attributes.strokeLayers();
    const StrokeLayer& is = layers[layer->number];
    if (!layer->isPresent) return "new layer " + is.name;
    return (is.isMerged ? "merging " : layers.open() == layer->number ? "opening " : "closing ") + is.name;
  }
  const auto* const values = std::get_if<FieldChange>(&change);
  const std::uint32_t field = values ? values->field : std::get<FieldPresence>(change).field;
  const std::string& name = attributes.fields()[field].values.name;
  if (name == kLockField) return values ? "lock" : "lock with a soft rim";
  return (values ? "values of " : "new field ") + name;
}

std::uint64_t countOf(const PointStroke& stroke) { return stroke.points.size(); }
std::uint64_t countOf(const PresenceStroke& stroke) { return stroke.points.count(); }
std::uint64_t countOf(const ShapeStroke& stroke) { return stroke.places.size(); }
std::uint64_t countOf(const AttributeChange& change) {
  if (const auto* const flip = std::get_if<MaskFlip>(&change)) return flip->points.count();
  const auto* const values = std::get_if<FieldChange>(&change);
  return values ? values->points.count() : 0;
}

}  // namespace

ChangeInWords inWords(const HistoryChange& change, const PointStates& present, const LayerAttributes& attributes) {
  return std::visit(
      [&](const auto& what) {
        const std::uint64_t count = countOf(what);
        return ChangeInWords{whatOf(what, present, attributes), count > 0 ? counted(count, "point") : ""};
      },
      change.what);
}

}  // namespace palpate
