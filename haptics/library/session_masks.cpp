// Points of a session that a program names by a mask.
#include "engine/core/counted.hpp"
#include "engine/edit/history.hpp"
#include "engine/select/point_bits.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/open_session.hpp"

namespace palpate::library {

const PointStates& OpenSession::maskable(std::size_t bytes, bool edits) {
  settleForCommand();
  session_->require(Action::select, "mask");
  if (!session_->pointHistory() || (edits && !session_.isEditable())) {
    if (isLive())
      throw StateError("the first mask of a session builds it for sculpting; set one before the session is live");
    session_.build(true, true);
  }
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
  auto out = mask.begin();
  const PointStates& points = maskable(mask.size(), false);
  const PointSet& set = session_->scene().layers[0].attributes.mask(role);
  for (const PointState& state : points)
    if (!state.gone) *out++ = set.test(state.number);
}

}  // namespace palpate::library
