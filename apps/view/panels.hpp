// What a person sees and turns in the window.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <span>

#include "apps/view/gui.hpp"
#include "apps/view/session.hpp"
#include "engine/render/frame_options.hpp"

namespace palpate {

/// How the model is shown, and how the mouse holds the stylus.
struct ViewSettings {
  ColorBy color = ColorBy::rgb;
  double discRadius_mm = 0;  ///< 0: each as wide as closes the surface
  bool smoothOutlines = false, scaleBar = true, dark = true;
  bool mesh = false;
  int lattice = 128;
  bool followsSurface = true;  ///< the stylus stays at the surface that is seen under the cursor; else in one plane
  double press_mm = 2.5;       ///< how deep the hand means to go while it presses
  bool waitsForDisplay = true;
  bool plots = true, help = false;
};

/// What is going on, for the panels.
struct ViewStatus {
  const Session* session = nullptr;  ///< null: none is open
  std::optional<double> loading;     ///< how far, 0 to 1
  std::string loadingWhat;
  std::vector<std::string> messages;  ///< the newest last; each is shown for a while
  std::span<const std::string> models, recent;
  std::string model;  ///< the one that is open
  bool asksAboutChanges = false;
  bool stylus = false;  ///< the mouse holds it
  std::string gpu;
  double meshTime_ms = 0;
  std::uint64_t meshTriangles = 0;
  const std::deque<float>* pictures_ms = nullptr;  ///< from picture to picture
  double fps = 0;
  std::vector<PassRecord> passes;  ///< of the last picture
};

/// What a person asks for.
struct ViewWishes {
  bool undo = false, redo = false, save = false, resetView = false, screenshot = false, exportTicks = false,
       endRecording = false, endPlaying = false, quit = false;
  bool saveFirst = false, discard = false, cancel = false;  ///< the answer about changes that are not saved
  std::optional<int> axis;
  std::string open, saveAs, record, play;
};

class Panels {
 public:
  explicit Panels(const Gui& gui) : gui_(gui) {}

  /// Between Gui::begin() and Gui::end(). Changes the settings as they are turned.
  ViewWishes draw(const ViewStatus& status, ViewSettings& view, ToolSettings& tool, FeelSettings& feel, bool& forcesOn);

 private:
  void drawModel(const ViewStatus& status, ViewWishes& wishes);
  void drawTool(const ViewStatus& status, ToolSettings& tool, ViewSettings& view, ViewWishes& wishes);
  void drawFeel(const ViewStatus& status, FeelSettings& feel, bool& forcesOn);
  void drawLook(const ViewStatus& status, ViewSettings& view, ViewWishes& wishes);
  void drawSession(const ViewStatus& status, ViewWishes& wishes);
  void drawPlots(const ViewStatus& status, ViewSettings& view, ViewWishes& wishes);
  void drawHelp(ViewSettings& view);
  void drawMessages(const ViewStatus& status, const ViewSettings& view);
  void drawQuestion(const ViewStatus& status, ViewWishes& wishes);
  float em(double units) const { return static_cast<float>(units * 14 * gui_.scale()); }

  const Gui& gui_;
  std::array<char, 512> open_{}, saveAs_{}, log_{};
  bool paused_ = false;
  struct Curves {
    std::vector<float> force_N, penetration_mm, step_us;
  } curves_;
};

}  // namespace palpate
