// The back ends that a program has, by name: a session asks for one and knows none of them.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/processor.hpp"
#include "engine/core/touch_backend.hpp"
#include "engine/core/touch_capabilities.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/motion/fused_stream.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// What a session needs of a back end.
struct BackendRequest {
  const Model& model;
  const SessionConfig& config;
  SurfaceOptions surface;             ///< as this back end realises the configuration's (BackendKind::surface())
  std::optional<BrushOptions> brush;  ///< the first one; model units
  bool paintable = false;             ///< keeps colours for a brush that comes later
  std::vector<ToolShape> tools;       ///< one for each hand, model units; without points for a single one
  unsigned threads = 0;               ///< on the CPU; 0: one per core
  /// Moves the model, and outlives what is made; null: it stands still, or is a scene of matter, which moves by itself.
  CloudSource* source = nullptr;
  std::optional<FusedStream> fusion;  ///< in place of a source, where the back end fuses frames: begins with the model
};

/// One way of answering poses.
class BackendKind {
 public:
  virtual ~BackendKind() = default;

  virtual std::string_view name() const = 0;
  /// How it can find neighbours; the first one unless another is asked for.
  virtual const std::vector<std::string>& methods() const = 0;
  virtual TouchCapabilities capabilities() const { return {}; }
  /// Memory that matter may take there, bytes.
  virtual std::uint64_t matterMemory_bytes() const { return matterMemory(hostMemory_bytes()); }
  /// Throws ConfigError for what it cannot do, as its capabilities say, and for matter that it has no memory for.
  void check(const SessionConfig& config) const;
  /// The surface that the configuration asks for on this model.
  SurfaceOptions surface(const Model& model, const SurfaceConfig& config) const {
    return surfaceOptions(model, config, capabilities().localRadius);
  }
  /// The machine that answers, in words.
  virtual std::string machine(unsigned threads) const = 0;
  /// How normals are estimated for a session on it: the same for the session and for its replay.
  virtual NormalEstimator normalEstimator() const { return estimateNormalsOnCpu; }
  /// A cloud ready to be touched, which keeps no reference to the request. Throws Error.
  virtual std::unique_ptr<TouchBackend> make(const BackendRequest& request) const = 0;
  /// Matter that moves by itself. Throws Error as planOf() does, and ConfigError where this back end moves none.
  virtual std::unique_ptr<MatterSimulation> simulate(const MatterScene& scene, const MatterOptions& options) const;
  /// The method that the configuration stands for.
  std::string methodOf(const BackendConfig& config) const {
    return config.method.empty() ? methods().front() : config.method;
  }

 protected:
  /// For a scene of matter, with a hand for each tool of the request.
  std::unique_ptr<TouchBackend> matterTouch(const BackendRequest& request) const;

 private:
  /// For a soft body, whose points make() has felt.
  std::unique_ptr<TouchBackend> softTouch(const BackendRequest& request) const;
};

/// The CPU, which every program has.
std::unique_ptr<BackendKind> cpuBackend();

/// All of a program's. One that is not among them is not known.
class Backends {
 public:
  explicit Backends(std::vector<std::unique_ptr<BackendKind>> kinds) : kinds_(std::move(kinds)) {}

  /// Throws ConfigError for a name that none has.
  const BackendKind& named(std::string_view name) const;
  std::vector<std::string> names() const;

 private:
  std::vector<std::unique_ptr<BackendKind>> kinds_;
};

}  // namespace palpate
