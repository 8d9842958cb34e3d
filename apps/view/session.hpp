#pragma once

#include <atomic>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include "apps/backend.hpp"
#include "apps/followers.hpp"
#include "apps/session_text.hpp"
#include "apps/view/tick_feed.hpp"
#include "haptics/devices/guided_touch.hpp"
#include "haptics/devices/turned_device.hpp"

namespace palpate {

/// What a person may turn while touching.
struct ToolSettings {
  std::optional<BrushKind> brush;  ///< nothing: only feel
  double radius_mm = 6, strength = 0.5, tau_mm = 0.5, beta = 0.1;
  std::uint32_t falloff = 1;
  std::array<std::uint8_t, 3> color{220, 40, 40};

  bool operator==(const ToolSettings&) const = default;
};
struct FeelSettings {
  SurfaceKind surface = SurfaceKind::average;
  QueryMethod method = QueryMethod::fused;
  double friction = 0;
  double stiffness_N_per_mm = 0.8, damping_N_s_per_mm = 0.002, maxForce_N = kTouchPeakForce_N;

  bool operator==(const FeelSettings&) const = default;
};

struct SessionOptions {
  ModelOptions model;
  BackendOptions backend;  ///< vulkan or cpu
  double rate_Hz = 1000;
  std::uint64_t undo_bytes = 1ull << 30;
  /// In a person's hand, in place of the mouse; it goes from model to model.
  std::shared_ptr<TurnedDevice> device;
  HapticDeviceFacts deviceFacts;
};

/// A model while it is felt, seen and sculpted: what answers, the servo thread, the drawn cloud, the journal and the
/// log. All but the constructor is for the thread that shows it; the constructor may run on another one before.
class Session {
 public:
  /// Builds everything on the GPUs. `sight`: where the picture is drawn. Throws Error.
  Session(Context& context, Device& sight, Model model, const SessionOptions& options, const ToolSettings& tool,
          const FeelSettings& feel);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const Model& model() const { return model_; }
  const std::string& file() const { return options_.model.file; }
  /// Of the model as it was loaded, model units relative to its origin.
  const Bounds& bounds() const { return bounds_; }
  double longestSide() const { return bounds_.longestSide(); }
  DrawnCloud& drawn() { return *followers_->drawn(); }
  std::string machine() const { return backend_->machine(); }
  std::string backendName() const { return options_.backend.backend; }

  /// Once for each picture: takes in what the servo thread has done, to the ticks and to the points. Says what went
  /// wrong since the last time; the session ends with it.
  std::optional<std::string> follow();
  const TickHistory& history() const { return history_; }
  /// Of the servo thread, where it last was; negative before its first tick.
  int servoCore() const { return feed_.core(); }
  /// What was done to the points since the last call, by whatever: for one who follows with a picture of his own.
  EditBatch takeBatch() { return std::exchange(batch_, {}); }
  std::uint64_t edits() const { return edits_; }  ///< states of points so far
  bool isTouching() const { return !lost_; }

  // The guided stylus; places in file coordinates. Without effect where a person holds a device.
  void aim(const DVec3& place) { stylus_.aim(place); }
  void lift() { stylus_.lift(); }
  void setForces(bool on) { forcesOn_ = on; }
  bool forcesOn() const { return forcesOn_; }

  const ToolSettings& tool() const { return tool_; }
  const FeelSettings& feel() const { return feel_; }
  /// The brush that the tool stands for.
  std::optional<BrushOptions> brush() const;
  /// The hand is without force for a moment.
  void setTool(const ToolSettings& tool);
  void setFeel(const FeelSettings& feel);

  const Journal& journal() const { return *journal_; }
  /// False where there is nothing to take back, or to do again.
  bool undo() { return takeBack(1, 0); }
  bool redo();

  /// Whether the points are others than those that were loaded, or saved last.
  bool isChanged() const { return journal_->version() != savedVersion_; }
  /// Writes the points as they are, on a thread of its own. A file that would lose something by it is kept.
  void save(const std::string& file);
  bool isSaving() const { return saving_.valid(); }
  /// What came of save(), once it is done: the file, as what an older one is kept, or what went wrong.
  struct Saved {
    std::string file, kept, failure;
  };
  std::optional<Saved> takeSaved();

  /// Session logs. A log says how the session goes from the model's file on, with one tool: it begins before the first
  /// edit, and ends with the next change of a setting. Throws Error.
  void record(const std::string& log);
  bool isRecording() const { return recording_ != nullptr; }
  /// What cannot be written into the recording, once.
  std::optional<std::string> takeRecordingFault();
  /// Throws FileError where not all could be written and takeRecordingFault() has not told it.
  void endRecording();
  /// Plays the hand of a recorded session; the guided stylus has no say meanwhile. Says what the log lacks.
  std::vector<std::string> play(const std::string& log);
  bool isPlaying() const { return playing_ != nullptr; }
  void endPlaying();

 private:
  struct Recording;

  HapticDevice& stylus();
  void start();
  void stop();
  // With the servo thread at rest, and all that it has done taken in.
  template <class Do>
  auto between(Do&& act) {
    stop();
    const Restart restart{*this};
    finishTicks();
    return act();
  }
  struct Restart {
    Session& session;
    ~Restart() {
      if (!session.lost_) session.start();
    }
  };
  void finishTicks();
  void takeIn();
  bool takeBack(std::size_t undo, std::size_t redo);

  Context& context_;
  SessionOptions options_;
  Model model_;
  Bounds bounds_;
  ToolSettings tool_;
  FeelSettings feel_;
  GuidedTouch stylus_;
  WorkspaceMap map_;
  std::unique_ptr<TouchBackend> backend_;
  std::optional<Followers> followers_;
  Journal* journal_ = nullptr;
  TickFeed feed_;
  TickHistory history_;
  std::vector<TraceRow> rows_;
  EditBatch batch_;
  std::uint64_t edits_ = 0, savedVersion_ = 0;
  std::atomic<bool> forcesOn_ = true, stop_ = false, ended_ = false;
  bool lost_ = false;
  double next_s_ = 0;
  std::string fault_;  // of the servo thread, once it has ended
  struct Playing {
    std::unique_ptr<HapticDevice> device;
    WorkspaceMap map;
    double end_s = 0;
  };
  std::unique_ptr<Playing> playing_;
  std::unique_ptr<Recording> recording_;
  std::future<Saved> saving_;
  std::uint64_t savingVersion_ = 0;
  std::jthread thread_;  // goes first
};

}  // namespace palpate
