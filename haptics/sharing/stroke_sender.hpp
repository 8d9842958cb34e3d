// Sends the edits of a hand to the server on the reliable path, and small ones also as copies.
#pragma once

#include <vector>

#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/sample_copies.hpp"
#include "haptics/sharing/stroke_outbox.hpp"

namespace palpate::sharing {

class StrokeSender {
 public:
  /// `session` must outlive it.
  explicit StrokeSender(const JoinedSession& session);
  /// Sends all that is pending to the server of that session, as far as the link has room, and the copies that are due.
  void send(StrokeOutbox& outbox, const Id& server);
  /// Sent pieces are sent again: drops the copies of them.
  void forgetCopies() { copies_.forget(); }

 private:
  bool write(const StrokePiece& piece, const Id& server);

  const JoinedSession& session_;
  Writer<Stroke> strokes_;
  SampleCopies<Stroke> copies_;
  std::vector<State> states_;  // of the piece that is written
};

}  // namespace palpate::sharing
