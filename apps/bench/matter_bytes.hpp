// Bytes that the passes of water and sand move on a GPU, for comparison with its bandwidth.
#pragma once

#include <map>
#include <string>

#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// Bytes of a pass that does its work.
struct PassBytes {
  double moved = 0;        ///< minimum from and to memory: each value once, however many invocations read it
  double asked = 0;        ///< including each particle's reads of its neighbours, most of which hit caches
  bool earlyExit = false;  ///< it mostly returns at once, because lists stay valid for several steps: its longest time
                           ///< is that of its work
};

/// By name of the pass. Derived from the shaders (shaders/matter) and the number of neighbours on the rest lattice,
/// without walls, models and tools.
std::map<std::string, PassBytes> matterBytes(const MatterScene& scene, std::size_t particles);

}  // namespace palpate
