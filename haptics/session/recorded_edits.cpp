#include "haptics/session/recorded_edits.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/packed_state.hpp"

namespace palpate {

namespace {

// Maximum number of states that a log lacks: as its gaps state, or have room for.
std::uint64_t mostMissingEdits(const SessionRecord& record) {
  std::uint64_t most = 0;
  for (const LogGap& gap : record.gaps) most += gap.states.value_or((gap.end - gap.begin) / sizeof(PackedState));
  return most;
}

bool isSame(std::span<const PointState> states, std::span<const PointChange> changes) {
  if (states.size() != changes.size()) return false;
  std::vector<PointState> ours(states.begin(), states.end()), theirs;
  for (const PointChange& change : changes) theirs.push_back(change.to);
  for (auto* each : {&ours, &theirs}) std::ranges::sort(*each, {}, &PointState::number);
  return ours == theirs;
}

// The number after the last point of a change.
std::uint64_t endOf(const AttributeChange& change) {
  if (const auto* const flip = std::get_if<MaskFlip>(&change)) return flip->points.end();
  if (const auto* const of = std::get_if<FieldChange>(&change)) return of->points.end();
  if (const auto* const strokes = std::get_if<StrokeLayerChange>(&change)) {
    std::uint64_t end = 0;
    for (const StrokeLayerPoint& point : strokes->points)
      end = std::max({end, point.after.number + 1, point.after.parent + 1, point.before.parent + 1});
    return end;
  }
  return std::get<FieldPresence>(change).points;
}

// In words, with the number of those that there are.
std::string misfit(const AttributeChange& change, const LayerAttributes& known) {
  if (const auto* const strokes = std::get_if<StrokeLayerChange>(&change))
    return fmt::format("layer of strokes {}, which does not exist or is another one; there are {} then",
                       strokes->number, known.strokeLayers().size());
  const auto* const of = std::get_if<FieldChange>(&change);
  return fmt::format("field {}, which does not exist or is another one; there are {} then",
                     of ? of->field : std::get<FieldPresence>(change).field, known.fields().size());
}

void requireAttributesOf(const std::filesystem::path& log, std::size_t most, const SessionRecord& record) {
  LayerAttributes known;  // fields without values
  for (const AttributeChange& change : record.edits.attributes) {
    if (endOf(change) > most)
      throw FileError(log, fmt::format("is damaged: it refers to point {}, but with all its edits there are only {}",
                                       endOf(change) - 1, most));
    if (!known.fits(change)) {
      if (!record.gaps.empty()) continue;
      throw FileError(log, "is damaged: it changes " + misfit(change, known));
    }
    if (const auto* const strokes = std::get_if<StrokeLayerChange>(&change)) {
      AttributeChange set = StrokeLayerChange{
          .number = strokes->number, .isPresent = strokes->isPresent, .set = strokes->set, .open = strokes->open};
      known.exchange(set);
    }
    const auto* const of = std::get_if<FieldPresence>(&change);
    if (!of) continue;
    AttributeChange empty = FieldPresence{
        .field = of->field, .isPresent = of->isPresent, .name = of->name, .unit = of->unit, .type = of->type};
    known.exchange(empty);
  }
}

}  // namespace

void requireEditsOf(const std::filesystem::path& log, std::size_t points, const SessionRecord& record) {
  const std::size_t most = points + record.edits.points.size() + mostMissingEdits(record);
  for (const PointState& state : record.edits.points)
    if (state.number >= most || state.parent >= most)
      throw FileError(log, fmt::format("is damaged: it refers to point {}, but with all its edits there are only {}",
                                       std::max(state.number, state.parent), most));
  requireAttributesOf(log, most, record);
}

namespace {

/// Applies one mark after another.
class EditsAgain {
 public:
  EditsAgain(History& history, LayerAttributes& attributes) : history_(history), attributes_(attributes) {}

  void follow(std::span<const PointState> states, EditMark::Kind kind) {
    const History::Carriers isThat{
        .points = [&](std::span<const PointChange> changes) { return isSame(states, changes); },
        .shape = [](ShapeStroke&) { return false; },
        .attributes = [](AttributeChange&) { return false; }};
    std::optional<StrokeLayerChange> ofLayer = std::exchange(ofLayer_, std::nullopt);
    const bool mayBeUndo = kind == EditMark::Kind::change && !states.empty() && !history_.inStroke();
    if (mayBeUndo && (history_.undo(isThat) || history_.redo(isThat))) return;
    std::vector<PointState> before;
    for (const PointState& state : states) before.push_back(history_.points()[state.number]);
    EditBatch batch{.points = {states.begin(), states.end()}, .marks = {{states.size(), kind}}};
    attributes_.follow(batch, history_.points());
    if (ofLayer && kind == EditMark::Kind::stroke) return slide(*ofLayer, states);
    history_.follow(batch);
    if (ofLayer && kind == EditMark::Kind::change) followInLayer(*ofLayer, before);
  }

  void change(AttributeChange change, EditMark::Kind kind) {
    if (!attributes_.fits(change)) return;
    if (const auto* const layer = std::get_if<StrokeLayerChange>(&change);
        layer && layer->moves != StrokeLayerChange::Points::none) {
      ofLayer_ = *layer;
      return;
    }
    if (kind == EditMark::Kind::attribute && slidesUnseen(change)) return;
    const auto exchange = [&](AttributeChange& made) { attributes_.exchange(made); };
    if (kind == EditMark::Kind::attribute) return history_.make(std::move(change), exchange);
    const History::Carriers isThat{.points = [](std::span<const PointChange>) { return false; },
                                   .shape = [](ShapeStroke&) { return false; },
                                   .attributes =
                                       [&](AttributeChange& kept) {
                                         if (!isSameChange(kept, change)) return false;
                                         exchange(kept);
                                         return true;
                                       }};
    const bool isKept = kind == EditMark::Kind::undone ? history_.undo(isThat) : history_.redo(isThat);
    if (!isKept) exchange(change);
  }

 private:
  // Of a field that is made again the values are not compared: removed points may have others.
  static bool isSameChange(const AttributeChange& a, const AttributeChange& b) {
    const auto* const made = std::get_if<FieldPresence>(&a);
    const auto* const other = std::get_if<FieldPresence>(&b);
    if (made && other) return made->field == other->field && made->isPresent == other->isPresent;
    const auto* const layer = std::get_if<StrokeLayerChange>(&a);
    const auto* const same = std::get_if<StrokeLayerChange>(&b);
    if (layer && same)
      return layer->number == same->number && layer->isPresent == same->isPresent && layer->set == same->set;
    return a == b;
  }

  // Another strength of a layer whose points do not exist.
  bool slidesUnseen(AttributeChange& change) {
    auto* const layer = std::get_if<StrokeLayerChange>(&change);
    const StrokeLayers& layers = attributes_.strokeLayers();
    if (!layer || layer->number >= layers.size() || !layer->isPresent) return false;
    if (layers[layer->number].shown() == layer->set.shown()) return false;
    slide(*layer, {});
    return true;
  }
  void slide(StrokeLayerChange& layer, std::span<const PointState> states) {
    history_.slide(
        layer, nullptr, [](const PointSet&, const History::MadeChanges&) { return true; }, states);
  }

  // What is undone or redone is not kept: the layer follows nevertheless.
  void followInLayer(const StrokeLayerChange& of, std::span<const PointState> before) {
    if (of.moves == StrokeLayerChange::Points::strokes)
      return attributes_.strokeLayers().record(of.number, before, history_.points());
    AttributeChange change = of;
    attributes_.exchange(change);
  }

  History& history_;
  LayerAttributes& attributes_;
  std::optional<StrokeLayerChange> ofLayer_;  // what the next states are of
};

}  // namespace

void followAgain(History& history, LayerAttributes& attributes, const EditBatch& edits) {
  history.setStrokeLayers(attributes.strokeLayers());
  EditsAgain again(history, attributes);
  const std::span<const PointState> all = edits.points;
  std::size_t begin = 0;
  auto change = edits.attributes.begin();
  for (const EditMark& mark : edits.marks) {
    const auto states = all.subspan(begin, mark.at - begin);
    begin = mark.at;
    if (!mark.hasAttribute()) {
      again.follow(states, mark.kind);
      continue;
    }
    if (!states.empty()) again.follow(states, EditMark::Kind::stroke);  // its own mark is missing
    again.change(*change++, mark.kind);
  }
  // The unfinished stroke at the program's end counts as a stroke.
  if (begin < all.size()) again.follow(all.subspan(begin), EditMark::Kind::stroke);
}

}  // namespace palpate
