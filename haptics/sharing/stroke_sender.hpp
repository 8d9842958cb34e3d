// What a hand has made, said to the server: the reliable way, and what is small as copies, too.
#pragma once

#include <vector>

#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/sample_copies.hpp"
#include "haptics/sharing/stroke_outbox.hpp"

namespace palpate::sharing {

class StrokeSender {
 public:
  /// `session` outlives it.
  explicit StrokeSender(const JoinedSession& session);
  /// All that waits, to the server of that session, as far as the link has room; and the copies that are due.
  void send(StrokeOutbox& outbox, const Id& server);
  /// What was sent goes again: of it there are no more copies.
  void forgetCopies() { copies_.forget(); }

 private:
  bool write(const StrokePiece& piece, const Id& server);

  const JoinedSession& session_;
  Writer<Stroke> strokes_;
  SampleCopies<Stroke> copies_;
  std::vector<State> states_;  // of the piece that is written
};

}  // namespace palpate::sharing
