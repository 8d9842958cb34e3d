// Neighbour lists, valid for some substeps.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/cell_grid.hpp"

namespace palpate {

/// Number of slots of a block, which one thread processes at a time. Blocks are fixed, so that sums over them do not
/// depend on the number of threads.
inline constexpr std::size_t kSlotsOfBlock = 256;
inline std::size_t blocksOf(std::size_t slots) { return (slots + kSlotsOfBlock - 1) / kSlotsOfBlock; }

/// A neighbour: its slot, and its nearest periodic image, 0 if that is the particle itself.
struct Neighbour {
  std::uint32_t slot : 27;
  std::uint32_t image : 5;
};

/// Maximum number of neighbours within the reach of a particle; more occur only in a failed simulation.
inline constexpr std::size_t kMaxNeighbours = 1000;

/// Lists are padded to a multiple of this, so that as many neighbours can be processed at once.
inline constexpr std::size_t kListedTogether = 8;

class NeighbourLists {
 public:
  /// `reach`: m.
  explicit NeighbourLists(float reach) : reach_(reach) {}

  /// Builds the lists for positions in the order of `grid`, sorted by it. False if a particle has more than
  /// kMaxNeighbours; its list is truncated.
  bool build(const CellGrid& grid, std::span<const Vec4> places, WorkerTeam& team);

  /// Neighbours of a slot, excluding itself, in the order of their slots. The slot after the last particle, which is
  /// nowhere, follows up to a multiple of kListedTogether.
  std::span<const Neighbour> of(std::size_t slot) const {
    const Block& block = blocks_[slot / kSlotsOfBlock];
    const std::size_t k = slot % kSlotsOfBlock;
    return std::span(block.neighbours).subspan(block.first[k], block.counts[k]);
  }
  /// The lists of a block one after another, filled up each; by slot the first entry and the number of neighbours.
  struct OfBlock {
    const Neighbour* neighbours;
    const std::uint32_t *first, *counts;
    std::size_t size;  ///< of all lists together
  };
  OfBlock ofBlock(std::size_t block) const {
    const Block& made = blocks_[block];
    return {made.neighbours.data(), made.first.data(), made.counts.data(), made.first.back()};
  }

 private:
  struct Block {
    std::vector<Neighbour> neighbours;  // may be longer than used
    std::vector<std::uint32_t> first;   // first index of each slot, and the total count
    std::vector<std::uint32_t> counts;  // number of neighbours of each slot
    bool crowded = false;
  };
  void buildBlock(const CellGrid& grid, std::span<const Vec4> places, std::size_t block);

  float reach_;
  std::vector<Block> blocks_;
  std::array<std::vector<float>, 3> along_;  // coordinates of the positions, for a few more than there are
};

}  // namespace palpate
