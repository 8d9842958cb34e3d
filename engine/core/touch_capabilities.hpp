#pragma once

#include <string_view>

namespace palpate {

/// What a back end can do beyond feeling the averaged surface with one point and pushing it: what the checks of a
/// configuration ask, so that none of them knows a back end by name.
struct TouchCapabilities {
  bool allSurfaces = true;       ///< every SurfaceKind; otherwise the average alone
  bool localRadius = true;       ///< takes the support radius place by place
  bool manyPoints = true;        ///< tools of many points (ToolShape)
  bool secondHand = true;        ///< answers two hands
  bool allBrushes = true;        ///< every BrushKind; otherwise push alone
  bool followsMotion = true;     ///< feels a cloud that a source moves
  bool fusesFrames = false;      ///< makes a map of depth frames itself; otherwise a source does, on the host
  bool movesSoftBodies = false;  ///< itself; otherwise the CPU does, and it feels their points
  bool matchesShapes = false;    ///< the same of soft bodies whose shapes are matched
  bool keepsEdits = true;    ///< reports its edits (TouchBackend::keepsEdits), so that they can be undone and logged
  bool asksAhead = false;    ///< takes a question before its pose is known
  bool choosesWait = false;  ///< can be told how to wait for the GPU
  bool timesPasses = false;  ///< measures each pass of a tick
  /// The one of its methods that answers more than one point: a tool of many, a second hand; empty where all do.
  std::string_view methodOfMany{};
};

}  // namespace palpate
