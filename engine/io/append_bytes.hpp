#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpate {

inline void appendBytes(std::vector<std::byte>& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

}  // namespace palpate
