// What the parts of Viewer work on together.
#pragma once

#include "apps/view/document.hpp"
#include "apps/view/gui.hpp"
#include "apps/view/held_device.hpp"
#include "apps/view/messages.hpp"
#include "apps/view/panels.hpp"
#include "apps/view/screen.hpp"
#include "apps/view/shown_model.hpp"
#include "apps/view/viewpoint.hpp"

namespace palpate {

/// Objects of the window that outlive its parts.
struct ViewerParts {
  Context& context;
  Window& window;
  WindowSettings& settings;
  Messages& messages;
  Gui& gui;
  Panels& panels;
  Screen& screen;
  Document& document;
  ShownModel& shown;
  Viewpoint& viewpoint;
  HeldDevice& held;
};

}  // namespace palpate
