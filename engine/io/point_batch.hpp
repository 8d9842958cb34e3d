#pragma once

#include <cstddef>

namespace palpate {

inline constexpr std::size_t kPointBatch = 4096;  ///< number of points that readers of text or columns process at a
                                                  ///< time

}  // namespace palpate
