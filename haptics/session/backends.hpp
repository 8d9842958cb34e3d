// The back ends of a program, by name: a session requests one without knowing its class.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/touch_capabilities.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/motion/fused_stream.hpp"
#include "engine/touch/touch_backend.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

/// How the engine works on a GPU, which changes no answer: not settings, since only the benches choose.
struct EngineChoices {
  SortMethod sort = kDefaultSort;           ///< of the index
  std::optional<std::uint32_t> spareSlots;  ///< of the index, for new points; empty: in proportion to the cloud
  std::optional<Wait> wait;                 ///< for the GPU; empty: by driver and cores
};

/// Arguments for making a back end.
struct BackendRequest {
  const Model& model;
  const SessionConfig& config;
  SurfaceOptions surface;             ///< the configuration's, as this back end supports it (BackendKind::surface())
  std::optional<BrushOptions> brush;  ///< the initial one; model units
  bool paintable = false;             ///< keeps colours for a later brush
  std::vector<ToolShape> tools;       ///< one for each hand, model units; without points for a single point
  unsigned threads = 0;               ///< on the CPU; 0: one per core
  /// Moves the model; must outlive the back end. Null: the model stands still, or is a scene of matter, which the back
  /// end simulates.
  CloudSource* source = nullptr;
  std::optional<FusedStream> fusion;  ///< in place of a source, if the back end fuses frames: begins with the model
  EngineChoices engine = {};
};

/// One kind of back end.
class BackendKind {
 public:
  virtual ~BackendKind() = default;

  virtual std::string_view name() const = 0;
  /// Methods of its neighbour search; the first one is the default.
  virtual const std::vector<std::string>& methods() const = 0;
  /// Whether it has this method in a palpate built with PALPATE_STUDY.
  virtual bool hasInStudy(std::string_view /*method*/) const { return false; }
  virtual TouchCapabilities capabilities() const { return {}; }
  /// What it simulates scenes with; null: it cannot.
  virtual const Simulator* simulator() const { return nullptr; }
  /// Throws ConfigError for what its capabilities exclude, and for a scene that exceeds its memory.
  void check(const SessionConfig& config) const;
  /// The surface of this model as configured.
  SurfaceOptions surface(const Model& model, const SurfaceConfig& config) const {
    return surfaceOptions(model, config, capabilities().localRadius);
  }
  /// Name of the answering machine.
  virtual std::string machine(unsigned threads) const = 0;
  /// The machine and its driver: while this is the same, so is its speed.
  virtual std::string identity(unsigned threads) const { return machine(threads); }
  /// Time that an idle machine needs to reach its usual clock, s.
  virtual double warmUp_s() const { return 0; }
  /// Estimator of normals for a session on it: the same for the session and for its replay.
  virtual NormalEstimator normalEstimator() const { return estimateNormalsOnCpu; }
  /// Throws GpuError if the machine has shown that its answers may be wrong: it may not move a hand. make() calls it
  /// for a session in real time. May take seconds, once for each machine.
  virtual void requireProof() const {}
  /// Makes a cloud that can be touched, which keeps no reference to the request. Throws Error.
  virtual std::unique_ptr<TouchBackend> make(const BackendRequest& request) const = 0;
  /// The configured method, or the default.
  std::string methodOf(const BackendConfig& config) const {
    return config.method.empty() ? methods().front() : config.method;
  }
};

/// The CPU, available in every program.
std::unique_ptr<BackendKind> cpuBackend();

/// All back ends of a program.
class Backends {
 public:
  explicit Backends(std::vector<std::unique_ptr<BackendKind>> kinds) : kinds_(std::move(kinds)) {}

  /// Throws ConfigError for an unknown name.
  const BackendKind& named(std::string_view name) const;
  std::vector<std::string> names() const;

 private:
  std::vector<std::unique_ptr<BackendKind>> kinds_;
};

}  // namespace palpate
