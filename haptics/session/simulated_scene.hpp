// A scene that a back end simulates, as the core knows it: the seam to the annex PALPATE_SIMULATION, which makes it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/core/simulation_control.hpp"

namespace palpate {

class BackendKind;
class SceneRef;
class TouchBackend;
struct BackendRequest;
struct Model;
struct ModelConfig;
struct ModelLoading;
struct SessionConfig;

/// Properties of a scene that a report states.
struct SceneReport {
  std::string_view matter;     ///< water, sand or soft
  std::uint32_t substeps = 0;  ///< in a millisecond
  double gain = 1;             ///< of the forces
  double coupling_N_mm = 0;    ///< of the hand to its ball, with the gain; 0: soft bodies
  std::string elasticity;      ///< of a soft body, in words
};

/// Stiffness of a body under a hand, with the gain of the forces.
struct BodyStiffness {
  double N_per_mm = 0;  ///< 0: undefined
  std::string why;      ///< it is undefined
};

/// A scene that runs without hands. For one thread at a time.
class FreeSimulation {
 public:
  struct Totals {
    double kinetic_J = 0, potential_J = 0;
    DVec3 momentum_kg_m_s{0};
    double maxCompression = 0;  ///< maximum relative excess of the density over that at rest
    double front_mm = 0;        ///< maximum x of the matter
    std::size_t particles = 0;
    std::size_t insideModel = 0;  ///< particles inside the body that stands in it
    DVec3 onModel_N{0};           ///< force on that body
  };

  virtual ~FreeSimulation() = default;
  /// Advances by a millisecond, unless it has failed.
  virtual void step() = 0;
  virtual void reset() = 0;
  virtual double time_s() const = 0;
  virtual std::uint32_t substeps() const = 0;
  /// Why it stopped, in words that follow "the simulation"; empty while it runs.
  virtual std::string failure() const = 0;
  virtual std::vector<SimulationParameter> parameters() const = 0;
  /// Throws Error, without effect.
  virtual void setParameter(std::string_view name, double value) = 0;
  /// The present points, mm.
  virtual CloudFrame frame() = 0;
  virtual Totals totals() const = 0;
};

/// Water, sand or a soft body, with a tool for each hand. Immutable.
class SimulatedScene {
 public:
  virtual ~SimulatedScene() = default;
  virtual bool equals(const SimulatedScene& other) const = 0;

  /// Whether its points are the surface of a soft body, which is felt as any other and may be sculpted. Otherwise they
  /// are particles, and a hand holds a ball among them.
  virtual bool isSoft() const = 0;
  virtual SceneReport report() const = 0;
  /// Stiffness of the body under a force distributed over a disc.
  virtual BodyStiffness stiffness(double radius_mm) const = 0;
  /// The scene as one line of JSON (parseScene()).
  virtual std::string text() const = 0;
  /// The same for programs that join it: without the folder of its model. Empty: they join its points as a surface.
  virtual std::string servedText() const = 0;
  /// The same scene with another value of a parameter of its simulation (SimulationControl). Throws Error.
  virtual SceneRef with(std::string_view parameter, double value) const = 0;

  /// Throws ConfigError for what cannot be simulated, or is incompatible with the rest of the configuration.
  virtual void check(const SessionConfig& config) const = 0;
  /// Throws ConfigError if it exceeds the memory of the back end, or that simulates nothing.
  virtual void check(const BackendKind& backend) const = 0;
  /// The points of its initial state. Throws Error.
  virtual Model load(const ModelConfig& config, const ModelLoading& loading) const = 0;
  /// Makes a simulation that can be touched, with a hand for each tool of the request. Throws Error.
  virtual std::unique_ptr<TouchBackend> touch(const BackendKind& backend, const BackendRequest& request) const = 0;
  /// Runs it without hands, as the model of that name. Throws Error.
  virtual std::unique_ptr<FreeSimulation> run(const BackendKind& backend, const std::string& name,
                                              const ModelLoading& loading) const = 0;
};

/// A scene, or none, as a value: compares by the scene's content.
class SceneRef {
 public:
  SceneRef() = default;
  explicit SceneRef(std::shared_ptr<const SimulatedScene> scene) : scene_(std::move(scene)) {}

  explicit operator bool() const { return scene_ != nullptr; }
  const SimulatedScene* operator->() const { return scene_.get(); }
  const SimulatedScene& operator*() const { return *scene_; }
  void reset() { scene_.reset(); }
  bool operator==(const SceneRef& other) const {
    if (!scene_ || !other.scene_) return scene_ == other.scene_;
    return scene_->equals(*other.scene_);
  }

 private:
  std::shared_ptr<const SimulatedScene> scene_;
};

/// What an annex keeps with the points of a scene: the body at rest, or the body that stands in the matter.
class SceneBody {
 public:
  virtual ~SceneBody() = default;
};

/// What a back end simulates scenes with. Made by the annex.
class Simulator {
 public:
  virtual ~Simulator() = default;
};

}  // namespace palpate
