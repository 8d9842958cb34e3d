// An interactive session: it runs on its own thread while brush, surface, force, hand and recording change.
#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "haptics/devices/guided_touch.hpp"
#include "haptics/devices/turned_device.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/tick_feed.hpp"
#include "haptics/session/unsaved_strokes.hpp"

namespace palpate {

struct LiveOptions {
  /// The device that a person holds; it replaces the guided stylus and is passed on from model to model.
  std::shared_ptr<TurnedDevice> device;
  HapticDeviceFacts deviceFacts;
  /// Clock of the ticks; it replaces the machine's and is passed on from model to model.
  std::shared_ptr<SteppedClock> clock;
  /// Folder in which unsaved strokes are kept for the next program, in case this one ends; empty: they are not kept.
  std::filesystem::path unsavedIn;
  /// Unsaved strokes of an earlier program on this model, with which the session continues; null: none.
  std::shared_ptr<const LeftStrokes> left;
};

/// Throws FileError where the model contains no points.
void requirePoints(const Model& model, const std::string& file);

/// Lets a person feel, see and sculpt a model, against the wall clock and without end. All but the constructor is for
/// one thread, the one that shows the model; the constructor may run on another thread.
class LiveSession {
 public:
  /// Builds everything. Without a brush in the configuration the surface is only felt until setBrush(). Throws Error.
  LiveSession(const SessionConfig& config, Model model, SessionParts parts, const LiveOptions& options);
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  const Model& model() const { return session_.model(); }
  const SurfaceOptions& surface() const { return session_.surface(); }  ///< in model units
  const SessionConfig& config() const { return session_.config(); }
  const std::string& file() const { return config().model.file; }
  /// Bounds of the model as loaded, model units relative to its origin.
  const Bounds& bounds() const { return bounds_; }
  double longestSide() const { return bounds_.longestSide(); }
  /// Throws the failure of the follower of the edits, if it failed.
  void checkFollower() const { session_.checkFollower(); }
  const std::string& machine() const { return session_.machine(); }

  /// Called once per frame: takes in the ticks and the edits of the servo thread. Returns what failed since the last
  /// call; the session ends with a failure.
  std::optional<std::string> follow();
  /// With LiveOptions::clock: runs the ticks up to that time, and follows.
  std::optional<std::string> tickUntil(double clock_s);
  const TickHistory& history() const { return seen_.history; }
  /// Core that the servo thread last ran on; negative before its first tick.
  int servoCore() const { return seen_.feed.core(); }
  /// All changes of the points since the last call (edits, undo, others' edits), for a caller with its own drawn copy.
  EditBatch takeBatch() { return std::exchange(seen_.batch, {}); }
  std::uint64_t edits() const { return seen_.edits; }  ///< number of point states so far
  bool isTouching() const { return !servo_.lost; }

  /// Stops the ticks until goOn(), so that another session may use the same GPU queues and the same device.
  void park();
  void goOn();

  // The guided stylus; positions in file coordinates. No effect where a person holds a device.
  void aim(const DVec3& place, bool sculpts = true) { stylus_.aim(place, sculpts); }
  void lift() { stylus_.lift(); }
  void setForces(bool on) { servo_.forcesOn = on; }
  bool forcesOn() const { return servo_.forcesOn; }

  /// The hand is without force for a moment. Ends a recording, which has one brush, one surface and one force law.
  void setBrush(const std::optional<BrushConfig>& brush);
  void setFeel(const SurfaceConfig& surface, const ForceOptions& force, const std::string& method);

  /// Sets a parameter of a simulation from the next step on (Session::setParameter()). Ends a recording.
  void setParameter(std::string_view name, double value);

  /// Pauses or resumes the frames of a depth camera; the hand is without force for a moment. Returns whether they are
  /// paused now; nothing where no frames are played.
  std::optional<bool> holdFrames();
  /// Goes to the next frame of a recorded camera while the frames are paused.
  void stepFrame();
  /// Whether frames are paused.
  bool holdsFrames() const { return held_; }
  /// Whether the points are a camera's frame that is paused while a person sculpts it (handOn()).
  bool isHeldStill() const { return !config().stream && model().stream && model().stream->player; }
  /// Exchanges edits with the other participants of a shared session; null where the model is not shared.
  SharedFollower* shared() { return session_.shared(); }
  const SharedFollower* shared() const { return session_.shared(); }
  /// Hands and cameras of the other participants, and this program's; null where no session was joined.
  SharedPresence* presence() const { return session_.presence(); }
  /// Fetches the points around the hands from the server that has the whole model; null for a local model.
  FarCloud* far() const { return session_.far(); }
  /// Control of a simulation; null where the model is not simulated.
  SimulationControl* simulation() const { return session_.simulation(); }
  /// The present points as a model; a camera's with its stream, which is paused and leaves this session. A session
  /// without a configured stream sculpts the points; one with a stream continues from them. Throws query failures.
  Model handOn();
  /// Session::releaseStream() at the time of the next tick.
  std::shared_ptr<PlayedStream> releaseStream();
  /// Session::playCounts().
  std::optional<PlayCounts> playCounts() const { return session_.playCounts(); }
  /// Session::playedView().
  std::optional<PlayedView> playedView() const { return session_.playedView(); }
  const Journal& journal() const { return *journal_; }
  /// False where there is nothing to undo, or to redo.
  bool undo() { return undoStrokes(1, 0); }
  bool redo();
  /// Strokes on the points, or on the rest shape of a soft body.
  StrokeCounts strokes() const;

  /// Whether the points, or that shape, differ from what was loaded or saved last.
  bool isChanged() const { return strokes().version != saving_.saved; }
  /// Writes the present points on another thread. A file that would lose data by this is kept under another name.
  void save(const std::string& file);
  bool isSaving() const { return saving_.running.valid(); }
  /// Result of save(): the file and the name that an older one is kept under, or the failure.
  struct Saved {
    std::string file, kept, failure;
  };
  std::optional<Saved> takeSaved();

  /// Sets the file name that unsaved strokes are later offered under.
  void setDocument(const std::string& file);
  /// Removes the strokes that are kept for the next program, saved or not.
  void leaveStrokes();
  /// Why unsaved strokes cannot be kept; returned once.
  std::optional<std::string> takeUnsavedFault();

  /// Records a session log. A log starts from the model's file and has one brush: it begins before the first edit and
  /// ends with the next change of a setting. Throws Error.
  void record(const std::string& log);
  bool isRecording() const { return session_.recording() != nullptr; }
  /// Why the recording cannot be written; returned once.
  std::optional<std::string> takeRecordingFault();
  /// Throws FileError where not all was written and takeRecordingFault() has not reported it.
  void endRecording();
  /// Plays the hand of a recorded session; the guided stylus is ignored meanwhile. Returns the gaps of the log.
  std::vector<std::string> play(const std::string& log);
  bool isPlaying() const { return playing_.has_value(); }
  void endPlaying();

 private:
  void start();
  void stop();
  // Calls `act` with the servo thread stopped and all its ticks and edits taken in.
  template <class Do>
  auto between(Do&& act) {
    stop();
    const Restart restart{*this};
    finishTicks();
    return act();
  }
  struct Restart {
    LiveSession& session;
    ~Restart() {
      if (!session.servo_.lost) session.start();
    }
  };
  OpenHand hand();
  void finishTicks();
  void takeIn();
  void keepUnsaved(const SessionConfig& config);
  void goOnWith(const LeftStrokes& left);
  bool undoStrokes(std::size_t undo, std::size_t redo);

  Session session_;
  LiveOptions options_;
  Bounds bounds_;
  bool held_ = false;
  Journal* journal_;
  GuidedTouch stylus_;
  WorkspaceMap map_;

  // Results of the servo thread, as taken in by the thread that shows the model.
  struct Seen {
    explicit Seen(double period_s) : history(period_s) {}
    TickFeed feed;
    TickHistory history;
    std::vector<TraceRow> rows;
    EditBatch batch;
    std::uint64_t edits = 0;
  } seen_;

  // The recorded hand that is being played.
  struct Playing {
    std::unique_ptr<HapticDevice> device;
    WorkspaceMap map;
    double end_s = 0;
  };
  std::optional<Playing> playing_;

  std::optional<UnsavedStrokes> unsaved_;
  struct Saving {
    std::future<Saved> running;
    std::uint64_t version = 0, saved = 0;  // of the strokes: being saved, saved last
  } saving_;

  struct Servo {
    std::atomic<bool> forcesOn = true, stop = false, ended = false;
    bool lost = false;
    double next_s = 0, clock_s = 0;
    std::string fault;  // valid once it has ended
    std::jthread thread;
  } servo_;  // destroyed first
};

}  // namespace palpate
