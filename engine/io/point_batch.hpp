#pragma once

#include <cstddef>

namespace palpate {

inline constexpr std::size_t kPointBatch = 4096;  ///< points per batch of readers of text or columns

}  // namespace palpate
