#include "haptics/sharing/stroke_server.hpp"

namespace palpate::sharing {

namespace {

constexpr std::int32_t kMaxSamples = 32'768;  // 1.4 KB each; dropped ones are sent again

}  // namespace

StrokeServer::StrokeServer(const Parts& parts)
    : parts_(parts), strokes_(parts.participant, parts.topics.strokes, keepingLast(reliableQos(false), kMaxSamples)) {
  counts_.sculptors = parts_.points.clients();
  counts_.states = parts_.points.head();
  if (parts_.journal) counts_.pieces = parts_.journal->pieces();
}

void StrokeServer::take() {
  strokes_.take([&](const Stroke& stroke) { take(stroke); });
}

void StrokeServer::take(const Stroke& stroke) {
  if (!isSame(stroke.session, parts_.session)) return;
  const std::span<const State> given(stroke.states._buffer, stroke.states._length);
  states_.clear();
  for (const State& state : given) states_.push_back(pointOf(state));
  const Id client = idOf(stroke.client);
  const SharedPoints::Taken taken = parts_.points.take(
      client, stroke.number, states_, std::span<const std::uint64_t>(stroke.replaced._buffer, stroke.replaced._length));
  counts_.sculptors = parts_.points.clients();
  switch (taken) {
    case SharedPoints::Taken::taken:
      ++counts_.pieces;
      counts_.states += states_.size();
      // As the points are now, since some of them may have kept another state.
      for (PointState& state : states_) state = parts_.points.points()[state.number];
      if (parts_.journal) parts_.journal->add({.client = client, .number = stroke.number, .states = states_});
      break;
    case SharedPoints::Taken::known:
    case SharedPoints::Taken::early:
      ++counts_.again;
      break;
    case SharedPoints::Taken::refused:
      if (counts_.refused++ == 0 && parts_.log)
        parts_.log->say(
            "a piece of a stroke was refused, and others may be: it is invalid, or {} hands have sculpted, which is "
            "the maximum",
            parts_.points.clients());
      break;
  }
}

}  // namespace palpate::sharing
