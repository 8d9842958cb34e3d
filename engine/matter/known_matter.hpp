// Known state of matter simulated on another machine: the particles around the hands at an earlier time.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

struct KnownMatter {
  std::vector<std::uint32_t> ids;           ///< permanent, ascending
  std::vector<Vec3> positions, velocities;  ///< one per id, m and m/s
  double time_s = 0;                        ///< time of the state
  std::size_t size() const { return ids.size(); }
};

/// Writes the known state into `known` and returns true; false if there is nothing new since the last call. For one
/// thread.
using MatterNews = std::function<bool(KnownMatter& known)>;

}  // namespace palpate
