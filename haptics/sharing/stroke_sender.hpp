// Sends the edits of a hand to the server.
#pragma once

#include <vector>

#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/stroke_outbox.hpp"

namespace palpate::sharing {

class StrokeSender {
 public:
  /// `session` must outlive it.
  explicit StrokeSender(const JoinedSession& session);
  /// Sends all that is pending to the server of that session, as far as the link has room.
  void send(StrokeOutbox& outbox, const Id& server);

 private:
  bool write(const StrokePiece& piece, const Id& server);

  const JoinedSession& session_;
  Writer<Stroke> strokes_;
  // Of the piece that is written.
  std::vector<State> states_;
  std::vector<std::uint64_t> replaced_;
};

}  // namespace palpate::sharing
