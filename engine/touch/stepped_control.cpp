#include "engine/touch/stepped_control.hpp"

namespace palpate {

std::string SteppedControl::failure() const {
  switch (state_.load()) {
    case MatterState::diverged:
      return "has diverged";
    case MatterState::crowded:
      return "has too many particles in one place";
    case MatterState::running:
      break;
  }
  return {};
}

std::uint32_t SteppedControl::stepsTo(std::int64_t step, std::uint32_t atFirst) {
  const std::int64_t steps = last_ ? step - *last_ : atFirst;
  last_ = step;
  if (mostAtOnce_ == 0 || steps <= mostAtOnce_) return static_cast<std::uint32_t>(steps);
  leftOut_.fetch_add(static_cast<std::uint64_t>(steps - mostAtOnce_), std::memory_order_relaxed);
  return mostAtOnce_;
}

}  // namespace palpate
