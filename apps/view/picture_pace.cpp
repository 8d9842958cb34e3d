#include "apps/view/picture_pace.hpp"

#include <algorithm>

namespace palpate {

double PicturePace::begin() {
  const double sinceLast_s = sinceBegin_.elapsed_s();
  sinceBegin_ = {};
  return sinceLast_s;
}

void PicturePace::end(bool shown, bool modelDrawn) {
  shown_ = shown;
  if (!shown) return;
  active_ = {};
  ++count_;
  if (!modelDrawn) return;
  constexpr std::size_t kCurve = 300;
  times_ms_.push_back(static_cast<float>(sinceBegin_.elapsed_us() * 1e-3));
  if (times_ms_.size() > kCurve) times_ms_.pop_front();
  constexpr double kSmooth = 0.1;
  const double now = 1e3 / std::max(1e-3, double{times_ms_.back()});
  fps_ = fps_ > 0 ? fps_ + kSmooth * (now - fps_) : now;
}

// A shown frame has waited for the display already.
double PicturePace::wait_s(bool lives) const {
  constexpr double kActive_s = 0.5, kRefresh_s = 1.0 / 60, kRest_s = 0.2;
  if (shown_) return 0;
  return lives || active_.elapsed_s() < kActive_s ? kRefresh_s : kRest_s;
}

}  // namespace palpate
