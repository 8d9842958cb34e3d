#pragma once

namespace palpate {

inline constexpr double kTick_s = 1e-3;

}  // namespace palpate
