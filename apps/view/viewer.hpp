#pragma once

#include <deque>
#include <filesystem>
#include <memory>

#include "apps/picture.hpp"
#include "apps/view/gui.hpp"
#include "apps/view/loader.hpp"
#include "apps/view/panels.hpp"
#include "apps/view/presentation.hpp"
#include "apps/view/recent_files.hpp"
#include "apps/view/script.hpp"
#include "apps/view/space_mouse.hpp"
#include "engine/mesh/marching_cubes.hpp"
#include "engine/render/frame.hpp"

namespace palpate {

struct ViewOptions {
  std::vector<std::string> models;
  SessionOptions session;  ///< the model's file is not looked at
  ToolSettings tool;
  FeelSettings feel;
  LookOptions look;
  UVec2 size_px{1280, 720};
  std::vector<TimedAction> script;
  std::optional<Presentation> presentation;  ///< what is found unless given
};

/// The window: shows the models, takes what a person does, and lets the person feel, sculpt and save. The force goes
/// its own way on the session's servo thread and waits for nothing here.
class Viewer {
 public:
  Viewer(Context& context, Window& window, Device& sight, ViewOptions options);
  ~Viewer();

  /// Until the window is closed, or the script says so.
  void run();

 private:
  // What the mouse does while a button is down.
  enum class Drag { none, orbit, pan, press };

  void step();
  void playScript();
  void act(const ScriptAction& action);
  void click(const std::string& name);
  void handle(const WindowEvent& event);
  void handleKey(const KeyEvent& event);
  void handleMouse(const DVec2& place_px);
  void handleButton(const ButtonEvent& event);
  void handleWheel(const WheelEvent& event);
  bool isDown(int left, int right) const;

  void load();
  void open(const std::string& file);
  // Does it now, or after the person was asked about changes.
  void leave(std::function<void()> then);
  bool asksAboutChanges() const { return afterQuestion_ != nullptr && !isSavingForIt_; }
  // To where Ctrl+S goes; asks first where a file would lose something.
  void save();
  void saveTo(const std::string& file);
  void answer(const ViewWishes& wishes);
  void install(std::unique_ptr<Session> session);
  void fitCamera();
  void keepClear(const UVec2& before_px, const UVec2& now_px);
  double freeCenter(double width_px) const;
  UpAxis up() const;
  LengthUnit unit() const;
  void obey(const ViewWishes& wishes);
  void tryTo(const std::function<void()>& act);
  void say(const std::string& message);
  void sayLost(const std::string& failure);
  void playLog(const std::string& log);

  void followSession();
  void playTicks();
  void showPaint();
  void moveStylus(double dt_s);
  void holdStylus(bool on);
  void useGamepad(double dt_s);
  void listenToSpaceMouse();
  void handlePush(const PushEvent& event);
  void usePush(double dt_s);
  std::optional<DVec3> placeUnderCursor() const;
  void applySettings();
  void remarkOnTool();
  void updateMesh();
  void draw(double dt_s);
  FrameOptions frameOptions() const;
  ViewStatus::ScaleBar scaleOfPicture() const;
  PictureSize pictureSize() const { return {presenter_->size_px().x, presenter_->size_px().y}; }
  // Makes the picture of the model where it would differ from the last one.
  void recordScene(CommandList& list);
  void recordPick(CommandList& list);
  void takePick();
  ViewStatus status();
  void screenshot(const std::string& file);
  // "MODEL<what>-1.<ending>" in the working folder, or the next number that is not there yet.
  std::string freeName(const std::string& what, const std::string& ending) const;
  void writeShown(const std::string& file, const UVec2& size_px);
  void writeState(const std::string& file);
  void exportTicks();

  DVec2 size() const { return DVec2(presenter_->size_px()); }

  Context& context_;
  Window& window_;
  Device& sight_;
  ViewOptions options_;
  Gui gui_;
  Panels panels_;
  PanelPass panelPass_;
  std::unique_ptr<Presenter> presenter_;
  CommandList list_;
  // What a picture of the model is made of: of the same comes the same picture.
  struct Scene {
    Camera camera;
    FrameOptions options;
    std::uint64_t edits = 0, mesh = 0;  // how many; which one, where it is drawn
    bool operator==(const Scene&) const = default;
  };
  std::unique_ptr<Frame> frame_;
  std::optional<Scene> scene_;  // of the picture that the frame has
  std::uint32_t shrink_ = 1;    // pixels of the window for one of the picture, along each side
  Buffer shown_, pick_;
  RecentFiles recent_;
  Loader loader_;
  std::unique_ptr<Session> session_;
  EditBatch edited_;  // since the last picture
  std::unique_ptr<MarchingCubes> mesh_;
  std::uint32_t meshLattice_ = 0, frameSupersample_ = 0;
  std::uint64_t meshes_ = 0;  // made or changed so far
  double meshTime_ms_ = 0;
  bool announcesMesh_ = false;  // the next picture waits for it

  ViewSettings view_;
  ToolSettings tool_;
  FeelSettings feel_;
  bool forcesOn_ = true;
  bool inStroke_ = false;
  std::optional<UpAxis> fittedUp_;  // as the settings had it when the camera was fitted last
  Camera camera_;
  bool closes_ = false, isClosed_ = false;
  std::function<void()> afterQuestion_;  // waits for the answer about changes
  bool isSavingForIt_ = false;
  std::optional<SaveQuestion> saveQuestion_;  // waits for its answer
  std::string saveFile_;                      // the model's own, or the one beside it

  std::array<bool, 512> keys_{};
  DVec2 cursor_px_{0};
  Drag drag_ = Drag::none;
  DVec3 pivot_{0};
  double dragDepth_ = 0;
  double clicked_s_ = -1e9;
  DVec2 clicked_px_{-1e9};
  bool stylus_ = false, stylusLocked_ = false, byGamepad_ = false;
  bool pressing_ = false;
  PushEvent push_;  // of the 3D mouse
  double hover_mm_ = 0, extraPress_mm_ = 0, padPress_ = 0;
  double planeDepth_ = 0;   // of the surface that the stylus goes by, and
  DVec2 planePlace_px_{0};  // where it was seen
  bool putDown_ = false;     // since it is held

  struct Pick {
    DVec2 place_px{0};
    double depth = 0;  // model units; 0: nothing is there
  };
  Pick asked_, picked_;
  struct Message {
    std::string text;
    Stopwatch since;
  };
  std::deque<Message> messages_;
  std::string lastMessage_, toolRemark_;
  std::deque<float> pictures_ms_;
  std::uint64_t pictures_ = 0, scenes_ = 0;  // shown; for which that of the model was made
  bool madeScene_ = false;                   // in this step
  bool wasShown_ = true;                     // the last picture, unless the display had no time for it
  bool passesAreNew_ = false;                // of the last picture, not looked at yet
  double scene_ms_ = 0;                      // of the last one of these
  std::vector<PassRecord> passes_;           // of that
  double moved_s_ = 0;  // when something did last, on clock_s()
  double fps_ = 0;
  std::string pendingScreenshot_;
  bool tellsOfScreenshot_ = true;

  std::optional<SpaceMouse> spaceMouse_;  // unless a script plays or a device is held

  // Under a script that goes by a clock of its own each picture is one step of it.
  bool ownClock() const { return options_.session.clock != nullptr; }
  static constexpr double kScriptStep_s = 0.05;
  // A person's, or the script's.
  double clock_s() const { return options_.script.empty() ? sinceStart_.elapsed_s() : scriptTime_s_; }
  Stopwatch sinceStart_;
  double scriptTime_s_ = 0;
  std::size_t nextAction_ = 0;
  bool impatient_ = false, asks_ = true;
  int looks_ = 0;  // for what is to be clicked, in vain
  std::size_t clickEnd_ = 0;
};

}  // namespace palpate
