// A session that a person plays with: it runs on a thread of its own, and brush, feel, hand and log change meanwhile.
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
  /// In a person's hand, in place of the guided stylus; it goes from model to model.
  std::shared_ptr<TurnedDevice> device;
  HapticDeviceFacts deviceFacts;
  /// Of the ticks, in place of the machine's; it goes from model to model.
  std::shared_ptr<SteppedClock> clock;
  /// Where strokes are kept that are not saved, for the next program should this one end; empty: nowhere.
  std::filesystem::path unsavedIn;
  /// Those on this model that a program before has left: the session goes on with them. Null: there are none.
  std::shared_ptr<const LeftStrokes> left;
};

/// Throws FileError where there is nothing to touch.
void requirePoints(const Model& model, const std::string& file);

/// A model while it is felt, seen and sculpted, against the wall clock and without end. All but the constructor is for
/// one thread, which shows it; the constructor may run on another one before.
class LiveSession {
 public:
  /// Builds everything. A configuration without a brush only feels until another one comes. Throws Error.
  LiveSession(const SessionConfig& config, Model model, SessionParts parts, const LiveOptions& options);
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  const Model& model() const { return session_.model(); }
  const SurfaceOptions& surface() const { return session_.surface(); }  ///< as it is felt, model units
  const SessionConfig& config() const { return session_.config(); }
  const std::string& file() const { return config().model.file; }
  /// Of the model as it was loaded, model units relative to its origin.
  const Bounds& bounds() const { return bounds_; }
  double longestSide() const { return bounds_.longestSide(); }
  /// Throws what went wrong with who follows the edits.
  void checkFollower() const { session_.checkFollower(); }
  std::string machine() const { return session_.backend().machine(); }

  /// Once for each picture: takes in what the servo thread has done, to the ticks and to the points. Says what went
  /// wrong since the last time; the session ends with it.
  std::optional<std::string> follow();
  /// With a clock of its own: plays the ticks until then, and follows.
  std::optional<std::string> tickUntil(double clock_s);
  const TickHistory& history() const { return seen_.history; }
  /// Of the servo thread, where it last was; negative before its first tick.
  int servoCore() const { return seen_.feed.core(); }
  /// What was done to the points since the last call, by whatever: for one who follows with a picture of his own.
  EditBatch takeBatch() { return std::exchange(seen_.batch, {}); }
  std::uint64_t edits() const { return seen_.edits; }  ///< states of points so far
  bool isTouching() const { return !servo_.lost; }

  /// Nothing touches it until goOn(): another session may use what its back end and its device do.
  void park();
  void goOn();

  // The guided stylus; places in file coordinates. Without effect where a person holds a device.
  void aim(const DVec3& place, bool sculpts = true) { stylus_.aim(place, sculpts); }
  void lift() { stylus_.lift(); }
  void setForces(bool on) { servo_.forcesOn = on; }
  bool forcesOn() const { return servo_.forcesOn; }

  /// The hand is without force for a moment. Ends a recording, which is of one brush and one feel.
  void setBrush(const std::optional<BrushConfig>& brush);
  void setFeel(const SurfaceConfig& surface, const ForceOptions& force, const std::string& method);

  /// A parameter of a simulation, from the next step on (Session::setParameter()). Ends a recording.
  void setParameter(std::string_view name, double value);

  /// Holds the frames of a depth camera, or lets them go on; the hand is without force for a moment. Whether they are
  /// held now; nothing where none are played.
  std::optional<bool> holdFrames();
  /// Recorded, while they are held: the next one.
  void stepFrame();
  /// Whether frames are held.
  bool holdsFrames() const { return held_; }
  /// Whether the points are those of a camera whose frames are held for as long as a person sculpts them (handOn()).
  bool isHeldStill() const { return !config().stream && model().stream && model().stream->player; }
  /// Where others feel and sculpt the model, too; null where nobody does.
  SharedFollower* shared() { return session_.shared(); }
  const SharedFollower* shared() const { return session_.shared(); }
  /// Where the hands and cameras of others are, and this program's; null where it was not joined.
  SharedPresence* presence() const { return session_.presence(); }
  /// What brings the points around the hands, where somebody else has all of them; null elsewhere.
  FarCloud* far() const { return session_.far(); }
  /// Of a model that moves by itself; null where it does not.
  SimulationControl* simulation() const { return session_.simulation(); }
  /// The points as they are, as a model: of a camera, with its frames, which are held from now on and which this
  /// session has no more. A session whose configuration has no stream sculpts the points; one that has it goes on from
  /// them once it lets its frames go on. Throws what a query could not.
  Model handOn();
  /// Session::releaseStream(), from now on.
  std::shared_ptr<PlayedStream> releaseStream();
  /// Session::playCounts().
  std::optional<PlayCounts> playCounts() const { return session_.playCounts(); }
  /// Session::playedView().
  std::optional<PlayedView> playedView() const { return session_.playedView(); }
  const Journal& journal() const { return *journal_; }
  /// False where there is nothing to take back, or to do again.
  bool undo() { return undoStrokes(1, 0); }
  bool redo();
  /// Of the points, or of the shape in which a soft body rests.
  StrokeCounts strokes() const;

  /// Whether the points, or that shape, are others than those that were loaded, or saved last.
  bool isChanged() const { return strokes().version != saving_.saved; }
  /// Writes the points as they are, on a thread of its own. A file that would lose something by it is kept.
  void save(const std::string& file);
  bool isSaving() const { return saving_.running.valid(); }
  /// What came of save(), once it is done: the file, as what an older one is kept, or what went wrong.
  struct Saved {
    std::string file, kept, failure;
  };
  std::optional<Saved> takeSaved();

  /// What the model is for a person, where its strokes are kept.
  void setDocument(const std::string& file);
  /// The strokes are not wanted any more, saved or not: those that are kept for the next program are removed.
  void leaveStrokes();
  /// Why they cannot be kept, once.
  std::optional<std::string> takeUnsavedFault();

  /// Session logs. A log says how the session goes from the model's file on, with one brush: it begins before the first
  /// edit, and ends with the next change of a setting. Throws Error.
  void record(const std::string& log);
  bool isRecording() const { return session_.recording() != nullptr; }
  /// What cannot be written into the recording, once.
  std::optional<std::string> takeRecordingFault();
  /// Throws FileError where not all could be written and takeRecordingFault() has not said so.
  void endRecording();
  /// Plays the hand of a recorded session; the guided stylus has no say meanwhile. Says what the log lacks.
  std::vector<std::string> play(const std::string& log);
  bool isPlaying() const { return playing_.has_value(); }
  void endPlaying();

 private:
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

  // What the servo thread has done, as the one who shows it has taken it in.
  struct Seen {
    explicit Seen(double period_s) : history(period_s) {}
    TickFeed feed;
    TickHistory history;
    std::vector<TraceRow> rows;
    EditBatch batch;
    std::uint64_t edits = 0;
  } seen_;

  // Another hand's recording, while it is played.
  struct Playing {
    std::unique_ptr<HapticDevice> device;
    WorkspaceMap map;
    double end_s = 0;
  };
  std::optional<Playing> playing_;

  std::optional<UnsavedStrokes> unsaved_;
  struct Saving {
    std::future<Saved> running;
    std::uint64_t version = 0, saved = 0;  // of the strokes
  } saving_;

  struct Servo {
    std::atomic<bool> forcesOn = true, stop = false, ended = false;
    bool lost = false;
    double next_s = 0, clock_s = 0;
    std::string fault;  // once it has ended
    std::jthread thread;
  } servo_;  // goes first
};

}  // namespace palpate
