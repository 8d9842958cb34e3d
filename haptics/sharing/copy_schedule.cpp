#include "haptics/sharing/copy_schedule.hpp"

namespace palpate::sharing {

void ByteBudget::fill(double now_s) {
  left_ = std::min(kAtOnce_s * rate_, left_ + rate_ * std::max(0.0, now_s - filled_s_));
  filled_s_ = std::max(filled_s_, now_s);
}

void ByteBudget::spend(std::size_t bytes, double now_s) {
  fill(now_s);
  left_ = std::max(0.0, left_ - static_cast<double>(bytes));
}

bool ByteBudget::take(std::size_t bytes, double now_s) {
  fill(now_s);
  if (left_ < static_cast<double>(bytes)) return false;
  left_ -= static_cast<double>(bytes);
  return true;
}

}  // namespace palpate::sharing
