// Replaces far_matter.cpp if palpate is built without PALPATE_SIMULATION.
#include "haptics/session/session_setup.hpp"
#include "haptics/sharing/brick_cloud.hpp"

namespace palpate {

std::unique_ptr<FarTouch> feelMatter(BrickSource&, const InformationAge&, const BackendSetup& setup) {
  throw NotBuilt(fmt::format("'{}' is a simulated scene and", setup.config.model.file), "PALPATE_SIMULATION");
}

}  // namespace palpate
