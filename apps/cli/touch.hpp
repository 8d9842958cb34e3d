// The options of `palpate touch`.
#pragma once

#include <functional>
#include <string>

#include "apps/cli/backend.hpp"
#include "apps/cli/hand_options.hpp"
#include "apps/cli/mask_options.hpp"
#include "apps/cli/motion_options.hpp"
#include "apps/cli/picture.hpp"
#include "apps/cli/sharing_options.hpp"
#include "apps/cli/stream_options.hpp"
#include "haptics/force_law.hpp"

namespace palpate {

struct TouchCommandOptions {
  ModelOptions model;
  BackendOptions backend{.backend = "auto"};
  PictureOptions picture;
  HandChoices hand;
  MotionOptions motion;
  StreamOptions stream;
  JoinOptionsGiven join;
  std::vector<std::string> hands;  ///< after the first, as given to --hand
  std::string path = "builtin:press", edit = "none";
  std::string traceFile, trajectoryFile, saveFile, pictureFile, logFile;
  double penetration_mm = HandConfig{}.penetration_mm;
  SessionConfig session;  ///< rate, duration and pace
  BrushConfig brush;
  UndoConfig undo;
  double layerStrength = 1;
  std::optional<Option> layer;  ///< of the command line: the strokes are a layer, of that strength
  MaskConditions masks;
  ForceOptions force;
  std::optional<Option> stiffness;  ///< of the command line
};
void addTouchOptions(Options& command, TouchCommandOptions& options);

/// Describes why a brush edits nothing on a cloud of that spacing, mm in the hand; empty if it does. `control`: name of
/// the control of the radius; `length` formats lengths.
std::string remarkOnSmallBrush(double radius_mm, double spacing_mm, std::string_view control,
                               const std::function<std::string(double mm)>& length);

/// Throws UsageError for incompatible options; before anything is loaded. `can`: of the back end.
void checkTouchOptions(const TouchCommandOptions& options, const TouchCapabilities& can);

/// The configuration according to the options. Throws UsageError.
SessionConfig sessionConfig(const TouchCommandOptions& options, Log& log);

}  // namespace palpate
