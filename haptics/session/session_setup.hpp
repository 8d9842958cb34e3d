// What a session is made of: its back end, from the configuration and the model.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptics/session/backends.hpp"
#include "haptics/session/far_touch.hpp"

namespace palpate {

/// The configuration, validated against the back end too. Throws ConfigError.
SessionConfig checked(SessionConfig config, const BackendKind& kind);

/// Why the model cannot be sculpted, with its name; empty: it can.
std::string fixedBecause(const SessionConfig& config, const Model& model);

/// The plane at which a brush is mirrored, relative to the cloud's origin; empty: it is not. An axis means the plane
/// through the middle of Model::shownBounds(), which iterates over all points.
std::optional<MirrorPlane> symmetryOf(const BrushConfig& brush, const Model& model);
/// A brush in model units.
std::optional<BrushOptions> brushOf(const std::optional<BrushConfig>& brush, const Model& model);
/// The tool of each hand, model units. Only the first one has the configured tool.
std::vector<ToolShape> toolsOf(const SessionConfig& config, const Model& model);

struct BackendSetup {
  const BackendKind& kind;
  const SessionConfig& config;
  const Model& model;
  const SurfaceOptions& surface;  ///< as felt, model units
  unsigned threads = 0;           ///< on the CPU; 0: one per core
  bool paintable = false;         ///< keeps colours for a later brush
  CloudSource* source = nullptr;  ///< moves the points; null: nothing, or the back end itself
  const std::optional<FusedStream>& fusion;
  EngineChoices engine = {};
};

/// A back end that was made.
struct MadeBackend {
  std::unique_ptr<TouchBackend> touch;
  FarTouch* far = nullptr;  ///< the same, if only the points around the hands are here
};

/// Throws Error, ConfigError.
MadeBackend makeBackend(const BackendSetup& setup);

}  // namespace palpate
