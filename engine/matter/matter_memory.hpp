#pragma once

#include "engine/gpu/buffer.hpp"
#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// How much of everything a simulation on a GPU has.
struct MatterSizes {
  std::uint32_t particles = 0;
  std::uint32_t blocks = 0;  ///< of shared::kMatterBlock slots
  std::uint32_t cells = 0;   ///< of the box
  std::uint32_t tools = 0;
  std::uint32_t bodyPoints = 0;  ///< of a tool's ball
  std::uint32_t bodyCells = 0;
  std::uint32_t modelNodes = 0;  ///< of the field about a model; 0: there is none
  std::uint32_t substeps = 1;    ///< in a step
  std::uint32_t mostListed = 0;  ///< neighbours in a list
  bool remembers = false;        ///< whether particles have contacts that remember

  std::uint32_t stride() const;  ///< of lists, slots
  std::uint32_t tiles() const;   ///< of the scan over all cells
};

/// What the passes of matter work on: shaders/shared/matter_passes.h says what stands in each. Throws OutOfGpuMemory.
struct MatterMemory {
  MatterMemory(Device& device, const MatterSizes& sizes);

  /// Parts of `state`, which is copied to the host as a whole.
  static constexpr std::uint64_t kControl = 0, kSums = 32, kTools = 92;
  std::uint64_t bytes() const;

  Buffer setting, hands;
  Buffer state, stateRead;
  struct Particles {
    Buffer places, positions, velocities, ids;
  } particles, sorted;
  Buffer pressed;
  Buffer lists, listLengths;
  struct Sort {
    Buffer firsts, tileSums, cells, arrivals, order;
  } sort;
  Buffer sums;
  Buffer bodyPoints, bodyFirsts;
  Buffer contacts, contactCounts;
};

}  // namespace palpate
