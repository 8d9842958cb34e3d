// Simulated matter that hands touch.
#pragma once

#include <memory>

#include "engine/matter/matter_scene.hpp"
#include "haptics/session/backends.hpp"

namespace palpate {

/// Makes a simulation on that back end, with a hand for each tool of the request. Throws Error.
std::unique_ptr<TouchBackend> touchMatter(const MatterScene& scene, const BackendKind& backend,
                                          const BackendRequest& request);

}  // namespace palpate
