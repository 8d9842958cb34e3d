// What a session is made of: its back end, from the configuration and the model.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "engine/touch/brick_touch.hpp"
#include "haptics/session/backends.hpp"

namespace palpate {

/// The configuration, validated against the back end too. Throws ConfigError.
SessionConfig checked(SessionConfig config, const BackendKind& kind);

/// Why the model cannot be sculpted, with its name; empty: it can.
std::string fixedBecause(const SessionConfig& config, const Model& model);

struct BackendSetup {
  const BackendKind& kind;
  const SessionConfig& config;
  const Model& model;
  const SurfaceOptions& surface;  ///< as it is felt, model units
  unsigned threads = 0;           ///< on the CPU; 0: one per core
  bool paintable = false;         ///< keeps colours for a later brush
  CloudSource* source = nullptr;  ///< moves the points; null: nothing, or the back end itself
  const std::optional<FusedStream>& fusion;
};

/// A back end that was made.
struct MadeBackend {
  std::unique_ptr<TouchBackend> touch;
  BrickTouch* bricks = nullptr;  ///< the same, if only the points around the hands are here
};

/// Throws Error, ConfigError.
MadeBackend makeBackend(const BackendSetup& setup);

}  // namespace palpate
