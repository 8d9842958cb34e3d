// The state of the window, as the event `state` of a script writes it.
#pragma once

#include <optional>

#include "apps/cli/results.hpp"
#include "apps/view/brush_in_hand.hpp"
#include "apps/view/document.hpp"
#include "apps/view/held_device.hpp"
#include "apps/view/messages.hpp"
#include "apps/view/panels.hpp"
#include "apps/view/picture_pace.hpp"
#include "apps/view/place_info.hpp"
#include "apps/view/selection.hpp"
#include "apps/view/settings.hpp"
#include "apps/view/volume_tool.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/render/camera.hpp"

namespace palpate {

struct WindowState {
  const Document& document;
  WindowTool tool = WindowTool::sculpt;
  const BrushSettings& brush;
  BrushHint brushHint;
  const SelectSettings& select;
  SelectionCounts selection;
  bool draws = false;  ///< an outline that selects, or a volume
  DrawnVolume volume;
  const ViewSettings& view;
  const ColoredField* field = nullptr;  ///< that colours the points
  const std::string& whereError;        ///< ViewStatus::whereError
  const Messages& messages;
  std::vector<std::string> notices;
  const Panels& panels;
  const std::string& blocked;  ///< ViewStatus::blocked
  const Camera& camera;
  UVec2 size_px{0};
  double scale = 1;     ///< Gui::scale()
  bool stylus = false;  ///< the mouse holds the stylus and touches
  std::uint64_t meshTriangles = 0;
  const PicturePace& pace;
  const std::vector<PassRecord>& passes;  ///< of the model's last picture
  std::uint64_t picturesOfModel = 0;
  std::size_t camerasShown = 0;
  const Measure& measure;
  std::optional<PlaceInfo> picked;
  double pickedDepth = 0;
  const HeldDevice& held;

  const WindowSession* session() const { return document.shown(); }  ///< null: no model is open
};

Json toJson(const WindowState& state);

/// Appends its keys.
void listWindowResults(std::vector<ResultFacts>& all);

}  // namespace palpate
