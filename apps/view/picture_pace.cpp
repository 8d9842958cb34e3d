#include "apps/view/picture_pace.hpp"

#include <algorithm>

namespace palpate {

void PicturePace::add(double time_ms) {
  constexpr std::size_t kCurve = 300;
  times_ms_.push_back(static_cast<float>(time_ms));
  if (times_ms_.size() > kCurve) times_ms_.pop_front();
  ++count_;
  constexpr double kSmooth = 0.1;
  const double now = 1e3 / std::max(1e-3, double{times_ms_.back()});
  fps_ = fps_ > 0 ? fps_ + kSmooth * (now - fps_) : now;
}

}  // namespace palpate
