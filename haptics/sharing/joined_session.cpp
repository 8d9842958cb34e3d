#include "haptics/sharing/joined_session.hpp"

#include "haptics/sharing/shared_points.hpp"

namespace palpate {

using namespace sharing;

std::optional<Results> resultsOf(const Points& sample, std::size_t points, std::vector<PointState>& states) {
  states.clear();
  for (const State& state : std::span<const State>(sample.states._buffer, sample.states._length)) {
    states.push_back(pointOf(state));
    if (!isWhole(states.back(), points)) return std::nullopt;
  }
  return Results{.epoch = sample.epoch,
                 .sample = sample.sample,
                 .acked = sample.acked,
                 .upTo = sample.upTo,
                 .head = sample.head,
                 .digest = sample.digest,
                 .states = states};
}

}  // namespace palpate
