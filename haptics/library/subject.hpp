// What a session of the C interface is of, and how its options configure it.
#pragma once

#include <optional>
#include <vector>

#include "haptics/library/joined_part.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/session/placed_clouds.hpp"

namespace palpate::library {

/// Model of a session: points of the program, or else what `model` describes.
struct Subject {
  ModelConfig model;
  const PointCloud* cloud = nullptr;
  std::vector<PlacedCloud> clouds;          ///< several, instead of `cloud`
  std::optional<pp_frames_options> frames;  ///< points that the program moves frame by frame
  std::optional<JoinSubject> join;          ///< how this program takes part in the session that the model joins

  bool hasArrays() const { return cloud || !clouds.empty(); }
};

/// Throws UsageError for options that are out of bounds.
SessionConfig configFrom(const Subject& subject, const pp_session_options& options);

/// Throws Error, such as for a model without points.
Model modelFrom(const Subject& subject, const SessionConfig& config, const ModelLoading& loading);

}  // namespace palpate::library
