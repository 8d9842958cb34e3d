#include "apps/view/shown_field.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "apps/view/selection.hpp"
#include "engine/select/prepared_cloud.hpp"

namespace palpate {

namespace {

// The points whose states or values in the field have changed, as they are now.
std::vector<PointState> changedIn(const EditBatch& edited, std::optional<std::uint32_t> layer,
                                  std::span<const PointState> points) {
  std::vector<PointState> changed(edited.points.begin(), edited.points.end());
  if (!layer) return changed;
  for (const AttributeChange& change : edited.attributes)
    if (const auto* const of = std::get_if<FieldChange>(&change); of && of->field == *layer)
      of->points.forEach([&](std::uint64_t point) {
        if (point < points.size()) changed.push_back(points[point]);
      });
  return changed;
}

bool hides(const AttributeChange& change) {
  const auto* const flip = std::get_if<MaskFlip>(&change);
  return flip && flip->role == MaskRole::hidden;
}

}  // namespace

void ShownField::show(WindowSession& session, const ViewSettings& view) {
  const Model& model = session.model();
  if (!session.session().pointHistory() || session.config().moves())
    throw Error("colour by {}: the points of this model move or are not all here, and have no fields", view.color.by);
  shown_.emplace(Shown{.field = ColoredField(view.color, model.cloud, session.attributes().fields(),
                                             {.mm_per_unit = mmPerUnit(model.cloud, session.config().model.mm_per_unit),
                                              .up = view.upOf(model)},
                                             view.unitOf(model)),
                       .by = view.color.by,
                       .up = view.upOf(model),
                       .layer = {}});
  readAll(session);
}

void ShownField::readAll(WindowSession& session) {
  shown_->layer = session.attributes().fieldNamed(shown_->by);
  shown_->field.read(session.history().points(), session.attributes().fields(), selectable(session));
  shown_->isStale = false;
  session.drawn().attributes().show(shown_->field.floats());
}

void ShownField::follow(WindowSession& session, const EditBatch& edited, const ViewSettings& view) {
  if (shown_ && (view.color.by != shown_->by || view.upOf(session.model()) != shown_->up)) {
    session.drawn().attributes().showNone();
    shown_.reset();
  }
  if (view.color.source()) return;
  try {
    if (!shown_) show(session, view);
    shown_->field.range(view.color);
  } catch (...) {
    shown_.reset();
    session.drawn().attributes().showNone();
    throw;
  }
  if (session.attributes().fieldNamed(shown_->by) != shown_->layer) return readAll(session);
  const std::vector<PointState> changed = changedIn(edited, shown_->layer, session.history().points());
  if (!changed.empty()) session.drawn().attributes().set(shown_->field.follow(changed, session.attributes().fields()));
  if (!changed.empty() || std::ranges::any_of(edited.attributes, hides))
    shown_->isStale = true;
  else if (std::exchange(shown_->isStale, false))
    shown_->field.summarise(selectable(session));
}

}  // namespace palpate
