// Points of a session that a program names by a mask, and its layers of strokes.
#include "engine/core/counted.hpp"
#include "engine/edit/history.hpp"
#include "engine/select/surface_select.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/open_session.hpp"

namespace palpate::library {

void OpenSession::keepPoints(Action action, std::string_view what, bool edits) {
  settleForCommand();
  session_->require(action, what);
  if (session_->pointHistory() && (!edits || session_.isEditable())) return;
  if (isLive())
    throw StateError("the first {} of a session builds it for sculpting; set one before the session is live", what);
  session_.build(true, true);
}

const PointStates& OpenSession::maskable(std::size_t bytes, bool edits) {
  keepPoints(Action::select, "mask", edits);
  const PointStates& points = session_->history()->points();
  if (bytes != points.present())
    throw UsageError("mask: {} were given, but there are {}", counted(bytes, "value"),
                     counted(points.present(), "point"));
  return points;
}

PointSet OpenSession::pointsOf(std::span<const std::uint8_t> mask, bool edits) {
  const PointStates& points = maskable(mask.size(), edits);
  PointBits bits(points.size());
  auto in = mask.begin();
  for (const PointState& state : points)
    if (!state.gone && *in++) bits.set(state.number);
  return bits.set();
}

void OpenSession::setMask(MaskRole role, std::span<const std::uint8_t> mask) {
  const PointSet points = pointsOf(mask, role != MaskRole::selected);
  session_->setMask(role, points);
  if (!isLive()) finish();
}

void OpenSession::changePoints(std::span<const std::uint8_t> mask, PointsAction action) {
  const PointSet points = pointsOf(mask, true);
  if (auto* const move = std::get_if<MovePoints>(&action)) {
    const DVec3& origin = session_->model().cloud.origin;
    move->offset = (*move)(origin)-origin;
  }
  session_->changePoints(points, action);
  if (!isLive()) finish();
}

void OpenSession::copyMask(MaskRole role, std::span<std::uint8_t> mask) {
  const PointStates& points = maskable(mask.size(), false);
  if (role == MaskRole::locked) {
    copyLockWeights(mask);
    for (std::uint8_t& weight : mask) weight = weight == PointLock::kWhole;
    return;
  }
  auto out = mask.begin();
  const PointSet& set = session_->scene().layers[0].attributes.mask(role);
  for (const PointState& state : points)
    if (!state.gone) *out++ = set.test(state.number);
}

void OpenSession::setLockWeights(std::span<const std::uint8_t> weights) {
  const PointStates& points = maskable(weights.size(), true);
  std::vector<std::uint8_t> next = session_->lockWeights();
  auto in = weights.begin();
  for (const PointState& state : points)
    if (!state.gone) next[state.number] = *in++;
  session_->setLockWeights(next);
  if (!isLive()) finish();
}

void OpenSession::copyLockWeights(std::span<std::uint8_t> weights) {
  const PointStates& points = maskable(weights.size(), false);
  const std::vector<std::uint8_t> all = session_->lockWeights();
  auto out = weights.begin();
  for (const PointState& state : points)
    if (!state.gone) *out++ = all[state.number];
}

void OpenSession::softenLock(double radius_mm) {
  if (!(radius_mm > 0)) throw UsageError("radius_mm: must be positive, not {}", radius_mm);
  settleForCommand();
  if (const History* const history = session_->history(); history && session_->pointHistory())
    maskable(history->points().present(), true);
  else
    maskable(session_->model().cloud.size(), true);
  const std::span<const PointState> points = session_->history()->points();
  session_->setLockWeights(softened(points, session_->lockWeights(), session_->model().scale.toUnits(radius_mm)));
  if (!isLive()) finish();
}

const StrokeLayers& OpenSession::layers() {
  keepPoints(Action::layer, "layer", true);
  return session_->scene().layers[0].attributes.strokeLayers();
}

std::uint32_t OpenSession::layerNamed(std::string_view name) {
  if (const auto number = layers().named(name)) return *number;
  throw UsageError("layer: the session has no layer of strokes named '{}'", name);
}

void OpenSession::openLayer(std::optional<std::string_view> name) {
  const StrokeLayers& known = layers();
  const std::optional<std::uint32_t> number = name ? known.named(*name) : known.open();
  if (number)
    session_->setStrokeLayer(*number, known[*number], name.has_value());
  else if (name)
    session_->setStrokeLayer(static_cast<std::uint32_t>(known.size()), {.name = std::string(*name)}, true);
  if (!isLive()) finish();
}

void OpenSession::setLayer(std::string_view name, bool continues, const std::function<void(StrokeLayer&)>& change) {
  const std::uint32_t number = layerNamed(name);
  StrokeLayer set = layers()[number];
  change(set);
  const bool isOpen = layers().open() == number && set == layers()[number];
  session_->setStrokeLayer(number, std::move(set), isOpen, continues);
  if (!isLive()) finish();
}

}  // namespace palpate::library
