#include "apps/view/link_history.hpp"

namespace palpate {

void LinkHistory::add(const SharedCounts& counts) {
  if (!age_ms_.empty() && last_.elapsed_s() < kApart_s) return;
  last_ = {};
  const auto keep = [](std::vector<float>& values, double value) {
    if (values.size() >= kKept) values.erase(values.begin());
    values.push_back(static_cast<float>(value));
  };
  keep(roundTrip_ms_, counts.link.roundTrip_ms.value_or(0));
  keep(lost_percent_, counts.link.lost_percent.value_or(0));
  keep(age_ms_, counts.age_s * 1e3);
}

void LinkHistory::clear() {
  roundTrip_ms_.clear();
  lost_percent_.clear();
  age_ms_.clear();
}

}  // namespace palpate
