// A scene of matter without hands, for the C interface.
#pragma once

#include <palpate/palpate.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "haptics/library/claims.hpp"
#include "haptics/library/gpu_half.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/library/watch.hpp"
#include "haptics/session/simulated_scene.hpp"

namespace palpate::library {

/// A scene by its name, or from a file. Throws UsageError that lists the built-in scenes, FileError, NotBuilt, and
/// Error for what cannot be simulated.
SceneRef openScene(const std::string& name);
/// Converts a parameter for programs; long texts are cut off.
pp_parameter parameterOf(const SimulationParameter& parameter);

/// Calls require an exclusive claim of the calling thread.
class OpenMatter {
 public:
  /// Throws Error.
  OpenMatter(const std::string& scene, const pp_matter_options& options, std::shared_ptr<Watch> watch);

  Claims& claims() { return claims_; }
  Watch& watch() { return *watch_; }
  /// Advances by `steps` milliseconds, or until it is stopped. Throws Stopped, and SimulationError if the scene fails
  /// meanwhile or has failed before.
  void step(std::uint64_t steps);
  void reset() { world_->reset(); }
  std::vector<SimulationParameter> parameters() const { return world_->parameters(); }
  /// Throws UsageError, without effect.
  void setParameter(std::string_view name, double value);
  std::shared_ptr<const FrameObject> frame();
  pp_matter_state state() const;

 private:
  std::shared_ptr<Watch> watch_;
  Claims claims_;
  GpuHalf gpu_;
  std::unique_ptr<BackendKind> backend_;
  std::string machine_;
  std::unique_ptr<FreeSimulation> world_;
};

}  // namespace palpate::library
