#include "haptics/rate_estimate.hpp"

namespace palpate {
namespace {

constexpr double kWindow_s = 0.001 * (1 - 1e-6);  // tolerance for whole ticks of times that are not exact in binary

}  // namespace

DVec3 RateEstimate::add(const DVec3& value, double dt_s) noexcept {
  newest_ = (newest_ + 1) % samples_.size();
  samples_[newest_] = {value, dt_s};
  if (count_ < samples_.size()) ++count_;

  double span_s = 0;
  std::size_t at = newest_;
  for (std::size_t back = 1; back < count_ && span_s < kWindow_s; ++back) {
    span_s += samples_[at].dt_s;
    at = (at + samples_.size() - 1) % samples_.size();
  }
  return span_s > 0 ? (value - samples_[at].value) / span_s : DVec3(0);
}

}  // namespace palpate
