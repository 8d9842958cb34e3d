#include "engine/edit/point_states.hpp"

#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {

PointStates::PointStates(const PointCloud& file)
    : states_(statesOf(file)), present_(states_.size()), file_(states_.size()) {}

void PointStates::flip(const PointSet& points) {
  const std::vector<PointSet::Word> words = points.list();
  const auto flipIn = [&](std::size_t begin, std::size_t end) {
    std::size_t gone = 0;
    for (std::size_t i = begin; i < end; ++i)
      words[i].forEach([&](std::uint64_t point, std::uint64_t) {
        PointState& state = states_[indexOf(point)];
        state.gone = !state.gone;
        gone += state.gone;
      });
    return gone;
  };
  const std::size_t gone = parallelReduce(words.size(), 0, std::size_t{0}, flipIn, std::plus());
  present_ += points.count() - 2 * gone;
}

void PointStates::exchange(std::span<PointState> states) {
  const auto exchangeIn = [&](std::size_t begin, std::size_t end) {
    std::int64_t added = 0;
    for (PointState& state : states.subspan(begin, end - begin)) {
      PointState& point = states_[indexOf(state.number)];
      added += int{point.gone} - int{state.gone};
      std::swap(point, state);
    }
    return added;
  };
  present_ += static_cast<std::size_t>(parallelReduce(states.size(), 0, std::int64_t{0}, exchangeIn, std::plus()));
}

void PointStates::grow(std::uint64_t point) {
  if (!index_) {
    while (states_.size() <= point) states_.push_back(never(states_.size()));
    return;
  }
  index_->emplace(point, states_.size());
  states_.push_back(never(point));
}

}  // namespace palpate
