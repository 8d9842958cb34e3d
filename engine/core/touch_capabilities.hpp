#pragma once

#include <string_view>

namespace palpate {

/// Capabilities of a back end beyond touching the averaged surface with one point and pushing it. Configuration checks
/// use them, so that they do not depend on a back end's name.
struct TouchCapabilities {
  bool allSurfaces = true;    ///< every SurfaceKind; otherwise the averaged surface alone
  bool localRadius = true;    ///< supports a local support radius
  bool manyPoints = true;     ///< tools of many points (ToolShape)
  bool manyHands = true;      ///< answers more than one hand
  bool allBrushes = true;     ///< every BrushKind; otherwise push alone
  bool followsMotion = true;  ///< a source can move the cloud
  bool fusesFrames = false;   ///< fuses depth frames into a map itself; otherwise a source does, on the host
  bool keepsEdits = true;     ///< reports its edits (TouchBackend::edits), so that they can be undone and logged
  bool asksAhead = false;     ///< accepts a query before its pose is known
  bool timesPasses = false;   ///< measures each pass of a tick
  /// Its method for several points (a tool of many points, a second hand); empty where all methods support them.
  std::string_view methodOfMany{};
};

}  // namespace palpate
