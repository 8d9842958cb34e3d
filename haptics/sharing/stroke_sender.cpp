#include "haptics/sharing/stroke_sender.hpp"

namespace palpate::sharing {

StrokeSender::StrokeSender(const JoinedSession& session)
    : session_(session), strokes_(session.participant, session.topics.strokes, reliableQos(false)) {}

void StrokeSender::send(StrokeOutbox& outbox, const Id& server) {
  while (const StrokePiece* piece = outbox.nextPiece(kStates)) {
    if (write(*piece, server)) continue;
    outbox.notSent();
    break;
  }
}

bool StrokeSender::write(const StrokePiece& piece, const Id& server) {
  Stroke stroke{};
  set(stroke.session, server);
  set(stroke.client, session_.client);
  stroke.number = piece.number;
  states_.clear();
  for (const PointState& point : piece.states) states_.push_back(stateOf(point));
  give(stroke.states, states_);
  replaced_ = piece.replaced;
  give(stroke.replaced, replaced_);
  return strokes_.write(stroke);
}

}  // namespace palpate::sharing
