#pragma once

#include "apps/view/brush_in_hand.hpp"
#include "apps/view/brush_notes.hpp"
#include "apps/view/clean_task.hpp"
#include "apps/view/document.hpp"
#include "apps/view/event_queue.hpp"
#include "apps/view/gui.hpp"
#include "apps/view/held_device.hpp"
#include "apps/view/keyboard.hpp"
#include "apps/view/messages.hpp"
#include "apps/view/named_views.hpp"
#include "apps/view/own_camera.hpp"
#include "apps/view/panels.hpp"
#include "apps/view/picture_pace.hpp"
#include "apps/view/pointing_devices.hpp"
#include "apps/view/screen.hpp"
#include "apps/view/script_player.hpp"
#include "apps/view/select_tool.hpp"
#include "apps/view/shown_model.hpp"
#include "apps/view/viewpoint.hpp"

namespace palpate {

struct ViewOptions {
  std::vector<std::string> models;
  WindowOptions session;  ///< its model's file is used only for a joined session or a live camera
  BrushSettings brush;
  FeelSettings feel;
  LookOptions look;
  ColorConfig color;
  LightConfig light;
  int resolution = 128;  ///< of the triangles
  UVec2 size_px{1280, 720};
  HeldDevice& held;
  std::vector<TimedAction> script;
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
  void step();
  void handle(const WindowEvent& event);
  void handleEvents(double wait_s);
  bool isFinishing() const;
  void playScript(double sinceLast_s);
  bool scriptWaits() const;
  void act(const TimedAction& timed);
  void click(const std::string& name);
  void await(const std::string& file);
  void carryOut(const ViewCommands& commands);
  void carryOut(const ViewCommand& command);
  void carryOutVolume(const ViewCommand& command);
  void carryOut(WindowCommand command);
  void carryOut(const FileCommand& command);
  void carryOut(DeviceCommand command);
  void carryOut(SelectCommand command);
  bool carryOut(BrushCommand command);
  void carryOut(const SelectWhere& command);
  void followCleaning(WindowSession& session);
  void carryOut(const SetColorRange& command);
  void carryOut(const NamedViewCommand& command);
  void load();
  void rest();
  void letGo();
  void welcome();
  void followSession();
  void followDevice();
  void followStiffness(std::optional<double> ofDevice_N_per_mm);
  void followName();
  void sayLost(const std::string& failure);
  void playTicks();
  void followTool();
  void press(MouseButton button);
  void applySettings();
  bool isSculpting();
  BrushSettings brushInHand();
  BrushHint brushHint();
  bool dragBrush(const WindowEvent& event, bool repeats);
  /// Returns whether a frame was shown: it would have differed from the last one.
  bool draw(double dt_s);
  /// How long to wait for events before the next frame.
  double wait_s();
  void keepClear(double before_px, double now_px);
  void fitCamera();
  void copyPlaces();
  void exportMesh(const std::string& file);
  void savePicture();
  void turnModel();
  void findPlaceInfo();
  Pointed pointed();
  ViewStatus status();
  std::vector<std::string> notices();
  ViewStatus::ScaleBar scaleOfPicture() const;
  DrawnVolume drawnVolume();
  void writeState(const std::string& file);

  Window& window_;
  WindowSettings settings_;
  Messages messages_;
  Gui gui_;
  Panels panels_;
  Screen screen_;
  PicturePace pace_;
  HeldDevice& held_;
  Document document_;
  std::string named_;  // in the window's title
  ShownModel shown_;
  Viewpoint viewpoint_;
  NamedViews views_;
  DVec2 free_px_{0};  // Panels::freeWidth_px() in the last frame
  OwnCamera ownCamera_;
  EventQueue events_;
  double now_s_ = 0, polled_s_ = 0;  // of the event that is handled, or of the frame; of the last look for events
  Keyboard keyboard_;
  PointingDevices pointing_;
  BrushInHand inHand_;
  SelectTool select_;
  CleanTask clean_;
  CountedSelection selection_;
  std::string whereError_;  // of the last condition
  Measure measure_;
  struct {
    std::uint64_t version = 0;  // of the measure
    std::optional<PlaceInfo> info;
  } picked_;
  BrushNotes brushNotes_;
  std::optional<double> ownStiffness_N_per_mm_;  // for other devices; set while a remembered one applies
  ScriptPlayer script_;
  enum class Closing { no, asked, done } closing_ = Closing::no;
};

}  // namespace palpate
