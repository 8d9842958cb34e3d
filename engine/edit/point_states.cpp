#include "engine/edit/point_states.hpp"

#include "engine/cloud/edited_cloud.hpp"

namespace palpate {

PointStates::PointStates(const PointCloud& file) : states_(statesOf(file)), present_(states_.size()) {}

void PointStates::grow(std::uint64_t point) {
  if (!index_) {
    while (states_.size() <= point) states_.push_back(never(states_.size()));
    return;
  }
  index_->emplace(point, states_.size());
  states_.push_back(never(point));
}

}  // namespace palpate
