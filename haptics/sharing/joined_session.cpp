#include "haptics/sharing/joined_session.hpp"

#include "haptics/sharing/shared_points.hpp"

namespace palpate {

using namespace sharing;

ResumeRequest requestOf(const JoinedSession& session, const Resume& asked) {
  ResumeRequest request{};
  set(request.session, session.session);
  set(request.client, session.client);
  put(request.host, ownHost());
  request.epoch = asked.epoch;
  request.upTo = asked.upTo;
  return request;
}

std::optional<Results> resultsOf(const JoinedSession& session, const Result& said, std::size_t points,
                                 std::vector<PointState>& states) {
  states.clear();
  if (!isSame(said.session, session.session)) return std::nullopt;
  for (const State& state : std::span<const State>(said.states._buffer, said.states._length)) {
    states.push_back(pointOf(state));
    if (!isWhole(states.back(), points)) return std::nullopt;
  }
  return Results{.epoch = said.epoch,
                 .counter = said.counter,
                 .acked = said.acked,
                 .upTo = said.upTo,
                 .head = said.head,
                 .digest = said.digest,
                 .states = states};
}

}  // namespace palpate
