// Replaces far_matter.cpp if palpate is built without simulation.
#include "engine/core/error.hpp"
#include "haptics/session/session_setup.hpp"
#include "haptics/sharing/brick_cloud.hpp"

namespace palpate {

std::unique_ptr<FarTouch> feelMatter(BrickSource&, const BackendSetup& setup) {
  throw Error("'{}' is simulated, and this palpate was built without PALPATE_SIMULATION", setup.config.model.file);
}

}  // namespace palpate
