#include "engine/spatial/pair_sort.hpp"

namespace palpate {

std::vector<RadixDigit> radixDigits(std::uint32_t keyBits, std::uint32_t mostBits) {
  PALPATE_CHECK_LE(keyBits, 32u);
  const std::uint32_t passes = (keyBits + mostBits - 1) / mostBits;
  std::vector<RadixDigit> digits;
  std::uint32_t shift = 0;
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    const std::uint32_t bits = keyBits / passes + (pass < keyBits % passes ? 1 : 0);
    digits.push_back({shift, bits});
    shift += bits;
  }
  return digits;
}

}  // namespace palpate
