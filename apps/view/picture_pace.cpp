#include "apps/view/picture_pace.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

namespace {

void keepLast(std::deque<float>& times_ms, double time_ms) {
  constexpr std::size_t kKept = 300;
  times_ms.push_back(static_cast<float>(time_ms));
  if (times_ms.size() > kKept) times_ms.pop_front();
}

}  // namespace

double PicturePace::begin() {
  const double sinceLast_s = sinceBegin_.elapsed_s();
  sinceBegin_ = {};
  return sinceLast_s;
}

void PicturePace::end(bool shown, bool modelDrawn) {
  shown_ = shown;
  const auto mouse = std::exchange(mouse_, std::nullopt);
  if (!shown) return;
  active_ = {};
  ++count_;
  if (!modelDrawn) return;
  drawnFor_ = mouse;
  keepLast(times_ms_, sinceBegin_.elapsed_us() * 1e-3);
  constexpr double kSmooth = 0.1;
  const double now = 1e3 / std::max(1e-3, double{times_ms_.back()});
  fps_ = fps_ > 0 ? fps_ + kSmooth * (now - fps_) : now;
}

void PicturePace::noteMouse(double age_s) {
  if (!mouse_ || mouse_->now_s() < age_s) mouse_ = Motion{.age_s = age_s, .since = {}};
}

void PicturePace::finish() {
  if (const auto motion = std::exchange(drawnFor_, std::nullopt)) keepLast(mouseToPicture_ms_, 1e3 * motion->now_s());
}

// A shown frame has waited for the display already.
double PicturePace::wait_s(bool lives) const {
  constexpr double kActive_s = 0.5, kRefresh_s = 1.0 / 60, kRest_s = 0.2;
  if (shown_) return 0;
  return lives || active_.elapsed_s() < kActive_s ? kRefresh_s : kRest_s;
}

}  // namespace palpate
