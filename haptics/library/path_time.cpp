#include "haptics/library/path_time.hpp"

namespace palpate::library {

Path PathTime::later(const Path& path) const {
  std::vector<PathKey> keys(path.keys().begin(), path.keys().end());
  for (PathKey& key : keys) key.t_s += next_s_;
  return Path(std::move(keys));
}

bool PathTime::goesOn(std::size_t hand, const Path& path, const ModelScale& scale) const {
  constexpr double kSamePlace_mm = 1;
  return next_s_ > 0 && hand < hips_.size() && scale.toMm(glm::distance(path.at(0), hips_[hand])) <= kSamePlace_mm;
}

void PathTime::restart() {
  next_s_ = 0;
  hips_.clear();
}

void PathTime::ended(const ServoResult& result, double tick_s) {
  if (!result.trace().rows.empty()) next_s_ = result.trace().rows.back().time_s + tick_s;
  hips_.clear();
  for (const HandResult& hand : result.hands)
    if (!hand.trace.rows.empty()) hips_.push_back(hand.trace.rows.back().hip);
}

void PathTime::ticked(double next_s) {
  reset_.store(false, std::memory_order_relaxed);
  hips_.clear();
  next_s_ = next_s;
}

}  // namespace palpate::library
