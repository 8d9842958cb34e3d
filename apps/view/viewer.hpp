#pragma once

#include "apps/view/command_runner.hpp"
#include "apps/view/hands.hpp"
#include "apps/view/kept_settings.hpp"
#include "apps/view/own_camera.hpp"
#include "apps/view/script_player.hpp"
#include "apps/view/window_report.hpp"

namespace palpate {

struct ViewOptions {
  std::vector<std::string> models;
  WindowOptions session;  ///< its model's file is used only for a joined session or a live camera
  BrushSettings brush;
  FeelSettings feel;
  LookOptions look;
  ColorConfig color;
  LightConfig light;
  GuideConfig guides;
  int resolution = 128;  ///< of the triangles
  UVec2 size_px{1280, 720};
  std::optional<DesktopPlace> place;  ///< of the window, in place of its size
  HeldDevice& held;
  std::vector<TimedAction> script;
  std::optional<bool> dark;                  ///< nothing: as the window was last
  std::optional<int> text_percent;           ///< likewise
  std::optional<Presentation> presentation;  ///< found automatically if not given
};

/// The window: shows the models, handles input, and lets the user feel, sculpt and save. The force is computed on the
/// session's servo thread, which never waits for the window.
class Viewer {
 public:
  Viewer(Context& context, Window& window, Device& sight, const ViewOptions& options);
  ~Viewer();

  /// Runs until the window is closed, or the script ends it.
  void run();

 private:
  ViewerParts parts(HeldDevice& held);
  void step();
  void handle(const WindowEvent& event);
  void playScript(double sinceLast_s);
  bool scriptWaits() const;
  void act(const TimedAction& timed);
  void click(const std::string& name);
  void await(const std::string& file);
  void load();
  void rest();
  void letGo();
  void welcome();
  void followSession();
  void followName();
  void keepSettings();
  void keepThumbnail();
  void sayLost(const std::string& failure);
  void playTicks();
  void applySettings();
  /// Returns whether a frame was shown: it would have differed from the last one.
  bool draw(double dt_s);
  /// How long to wait for events before the next frame.
  double wait_s();
  void keepClear(double before_px, double now_px);

  Context& context_;
  Window& window_;
  WindowSettings settings_;
  Messages messages_;
  Gui gui_;
  Panels panels_;
  Screen screen_;
  PicturePace pace_;
  Document document_;
  std::string named_;  // in the window's title
  ShownModel shown_;
  Viewpoint viewpoint_;
  DVec2 free_px_{0};  // Panels::freeWidth_px() in the last frame
  OwnCamera ownCamera_;
  BrushNotes brushNotes_{settings_.feel.handGain};
  Hands hands_;
  CommandRunner commands_;
  WindowReport report_;
  HeldDevice& held_;
  ScriptPlayer script_;
  KeptSettings kept_;  // as they are in their file
  bool keepsPlace_;    // of the window: not that of a script
  bool isClosed_ = false;
};

}  // namespace palpate
