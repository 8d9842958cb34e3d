// Who is near whom, for some substeps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/worker_team.hpp"
#include "engine/matter/cell_grid.hpp"

namespace palpate {

/// Slots that one thread works on at a time, always the same ones: sums over them do not depend on the threads.
inline constexpr std::size_t kSlotsOfBlock = 256;
inline std::size_t blocksOf(std::size_t slots) { return (slots + kSlotsOfBlock - 1) / kSlotsOfBlock; }

/// A neighbour: its slot, and the image of it that is near.
struct Neighbour {
  std::uint32_t slot : 27;
  std::uint32_t image : 5;
};

/// More within the reach of one particle are a state that no simulation comes to which is still one.
inline constexpr std::size_t kMaxNeighbours = 1000;

/// Lists are filled up to a multiple of it, so that so many can be taken at once.
inline constexpr std::size_t kListedTogether = 4;

class NeighbourLists {
 public:
  /// `reach`: m.
  explicit NeighbourLists(float reach) : reach_(reach) {}

  /// For places in the order of `grid`, which was sorted by them. False where a particle has more than kMaxNeighbours,
  /// of which the list holds no more.
  bool build(const CellGrid& grid, std::span<const Vec4> places, WorkerTeam& team);

  /// Of a slot, without itself, in the order of their slots.
  std::span<const Neighbour> of(std::size_t slot) const {
    const Block& block = blocks_[slot / kSlotsOfBlock];
    const std::size_t k = slot % kSlotsOfBlock;
    return std::span(block.neighbours).subspan(block.first[k], block.counts[k]);
  }
  /// The same with copies of the last one behind them, to a whole number of kListedTogether.
  std::span<const Neighbour> filledUp(std::size_t slot) const {
    const Block& block = blocks_[slot / kSlotsOfBlock];
    const std::size_t k = slot % kSlotsOfBlock;
    return std::span(block.neighbours).subspan(block.first[k], block.first[k + 1] - block.first[k]);
  }
  /// Where those of a slot begin among all of its block.
  std::size_t firstOf(std::size_t slot) const { return blocks_[slot / kSlotsOfBlock].first[slot % kSlotsOfBlock]; }
  /// Neighbours in a block, with copies.
  std::size_t inBlock(std::size_t block) const { return blocks_[block].first.back(); }

 private:
  struct Block {
    std::vector<Neighbour> neighbours;  // and room for more
    std::vector<std::uint32_t> first;   // of each slot, and their number
    std::vector<std::uint32_t> counts;  // of each slot, without copies
    bool crowded = false;
  };
  void buildBlock(const CellGrid& grid, std::span<const Vec4> places, std::size_t block);

  float reach_;
  std::vector<Block> blocks_;
};

}  // namespace palpate
