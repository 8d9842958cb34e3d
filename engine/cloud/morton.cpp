#include "engine/cloud/morton.hpp"

#include <algorithm>
#include <atomic>
#include <limits>

#include "engine/core/check.hpp"

namespace palpate {

void MortonCells::fillTable(unsigned threads) {
  PALPATE_CHECK_LT(codes_.size(), std::size_t{std::numeric_limits<std::uint32_t>::max()});
  const auto begins =
      parallelRuns(codes_.size(), threads, [&](std::size_t i) { return codes_[i] >> 3 == codes_[i - 1] >> 3; });
  cubes_.resize(std::bit_ceil(2 * begins.size()));
  parallelFor(cubes_.size(), threads, [&](std::size_t begin, std::size_t end) {
    std::fill(&cubes_[begin], cubes_.data() + end, Cube{kNone, 0, 0});
  });
  // The first thread takes a slot; each cube can be found, in any order of insertion.
  parallelFor(begins.size() - 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint64_t code = codes_[begins[k]] >> 3;
      std::size_t slot = slotOf(code);
      for (std::uint64_t empty = kNone; !std::atomic_ref(cubes_[slot].code).compare_exchange_strong(empty, code);
           empty = kNone)
        slot = (slot + 1) & (cubes_.size() - 1);
      cubes_[slot].first = static_cast<std::uint32_t>(begins[k]);
      for (std::size_t cell = begins[k]; cell < begins[k + 1]; ++cell)
        cubes_[slot].occupied |= std::uint32_t{1} << (codes_[cell] & 7);
    }
  });
}

}  // namespace palpate
