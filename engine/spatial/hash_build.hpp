// Common types of the two ways to build a SpatialHash, sorting and counting.
#pragma once

#include <cstdint>

#include "engine/spatial/hash_grid.hpp"
#include "engine/spatial/live_cloud.hpp"

namespace palpate {

/// A full build: writes the points of `count` slots of `from` to `to` in the order of their buckets.
struct HashBuild {
  const LiveCloud::Half& from;
  const LiveCloud::Half& to;
  const Buffer& ranges;  ///< of the buckets in `to`
  std::uint32_t count = 0;
};

/// Memory for a build: words by slot.
struct HashBuildScratch {
  HashBuildScratch(Device& device, std::uint32_t slots);
  std::uint64_t bytes() const { return keys.bytes() + order.bytes() + keysAlt.bytes() + orderAlt.bytes(); }

  Buffer keys, order, keysAlt, orderAlt;
};

}  // namespace palpate
