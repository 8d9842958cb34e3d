// What each back end simulates matter with.
#pragma once

#include "engine/matter/matter_simulation.hpp"
#include "haptics/session/backends.hpp"

namespace palpate {

class MatterSimulator : public Simulator {
 public:
  /// Maximum memory of a scene on its machine, bytes.
  virtual std::uint64_t memory_bytes() const = 0;
  /// Throws Error as planOf() does.
  virtual std::unique_ptr<MatterSimulation> simulate(const MatterScene& scene, const MatterOptions& options) const = 0;
};

/// Throws ConfigError if this back end simulates no matter.
const MatterSimulator& simulatorOf(const BackendKind& backend);

}  // namespace palpate
