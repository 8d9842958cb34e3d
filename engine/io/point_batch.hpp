#pragma once

#include <cstddef>

namespace palpate {

inline constexpr std::size_t kPointBatch = 4096;  ///< points that a reader of text or of columns hands over at a time

}  // namespace palpate
