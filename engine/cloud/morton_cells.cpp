#include "engine/cloud/morton_cells.hpp"

#include <bit>
#include <utility>

#include "engine/core/check.hpp"

namespace palpate {

MortonCells::MortonCells(std::vector<std::uint64_t> codes) : codes_(std::move(codes)) {
  PALPATE_CHECK_LT(codes_.size(), std::size_t{kNone});
  slots_.assign(std::bit_ceil(2 * codes_.size() + 1), kNone);
  for (std::uint32_t cell = 0; cell < codes_.size(); ++cell) {
    std::size_t slot = slotOf(codes_[cell]);
    while (slots_[slot] != kNone) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = cell;
  }
}

}  // namespace palpate
