// What is known of matter that somebody else simulates: the particles around the hands, as they were some time ago.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

struct KnownMatter {
  std::vector<std::uint32_t> ids;           ///< for life, ascending
  std::vector<Vec3> positions, velocities;  ///< one for each, m and m/s
  double time_s = 0;                        ///< that they are true for
  std::size_t size() const { return ids.size(); }
};

/// Puts what is known now into what it is given, and says true; false where nothing is new since the last call. For one
/// thread.
using MatterNews = std::function<bool(KnownMatter& known)>;

}  // namespace palpate
