// What the passes of water and sand move on a GPU, to be held against its bandwidth.
#pragma once

#include <map>
#include <string>

#include "engine/matter/matter_scene.hpp"

namespace palpate {

/// Of a pass that does its work.
struct PassBytes {
  double moved = 0;         ///< from memory and to it at the least: each value once, however many ask for it
  double asked = 0;         ///< with what each particle asks of its neighbours, most of which caches answer
  bool mostlyEnds = false;  ///< at once, as lists are good for a while: it has done its work where it took longest
};

/// By the name of the pass. Counted from what stands in each (shaders/matter), with the neighbours that a particle has
/// on the lattice on which matter rests, and without what walls, models and tools add.
std::map<std::string, PassBytes> matterBytes(const MatterScene& scene, std::size_t particles);

}  // namespace palpate
