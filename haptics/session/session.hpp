// A session: a model, what answers, and who follows what is done to it, put together once for every program.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "engine/touch/brick_touch.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session/abilities.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/edit_relay.hpp"
#include "haptics/session/hand_source.hpp"
#include "haptics/session/moving_model.hpp"
#include "haptics/session/session_recording.hpp"

namespace palpate {

/// Makes who follows the edits of a session, from the back end as it begins.
using FollowerMaker = std::function<std::unique_ptr<EditFollower>(const Model& model, TouchBackend& backend)>;

/// How long a session waits for what others do to be everywhere, and for what it did itself, unless it is told
/// otherwise.
inline constexpr double kSharedPatience_s = 10;
/// The same before a session ends, for a server that is not heard.
inline constexpr double kUnheard_s = 5;

/// What a session is given beside its configuration.
struct SessionParts {
  const BackendKind& backend;
  unsigned threads = 0;  ///< on the CPU; 0: one per core
  bool journal = false;  ///< keeps what is done to the points, for undo, saving and logs, where the back end reports it
  std::uint64_t undo_bytes = 0;  ///< for strokes that can be taken back
  bool paintable = false;        ///< keeps colours for a brush that comes later
  /// How long run() and finish() wait for the others, where there are some.
  double sharedPatience_s = kSharedPatience_s;
  /// Hears of frames that do not go into the map of a depth camera, and of strokes that did not arrive; outlives the
  /// session.
  Log* log = nullptr;
  /// Moves the points, where the configuration says nothing of it; outlives the session. Null: nothing does.
  CloudSource* source = nullptr;
  FollowerMaker follower;  ///< empty: nobody follows but the journal and the log
};

/// How a run goes beside what the configuration says of it. All that is pointed to outlives it.
struct RunOptions {
  double begin_s = 0;                           ///< the time of the first tick
  double rate_Hz = 0;                           ///< ticks per second; 0: as the configuration says
  bool endless = false;                         ///< against the wall clock until `stop`
  SteppedClock* clock = nullptr;                ///< in place of the machine's (ServoOptions::clock)
  const std::atomic<bool>* stop = nullptr;      ///< ends it when it becomes true; null: that of the job (JobStop)
  const std::atomic<bool>* forcesOn = nullptr;  ///< no force while it is false (ServoOptions::forcesOn)
  TickRecorder* recorder = nullptr;             ///< notified of each tick
  TickObserver observer;                        ///< after each tick in virtual time
  ContactQuery* query = nullptr;                ///< asked in place of the back end, to which it passes on
  bool realtime = false;                        ///< against the wall clock, whatever the configuration says
  CustomForce law;                              ///< the first hand's, in place of spring and damper (ForceLaw)
};

/// The points as a session leaves them.
struct SculptedCloud {
  PointCloud cloud;
  std::size_t edited = 0;  ///< stand elsewhere than in the file, have another colour, are gone, or are new
};

/// What a hand with this law is to a surface that gives way.
HandSpring springOf(const ForceLaw& law);

/// One thread uses it at a time; the one that runs it is the servo thread in real time.
class Session {
 public:
  /// Builds the index. `model` has points and normals; sessions may share it. Throws Error, ConfigError.
  Session(SessionConfig config, std::shared_ptr<const Model> model, const SessionParts& parts);
  Session(SessionConfig config, Model model, const SessionParts& parts);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const SessionConfig& config() const { return config_; }
  const Model& model() const { return *model_; }
  /// As it is felt, model units.
  const SurfaceOptions& surface() const { return surface_; }
  std::string method() const { return kind_.methodOf(config_.backend); }
  /// What can be done with the model, and why not what cannot.
  Abilities abilities() const;
  /// Throws Error "WHAT: the refusal" where the model or the back end refuses the action.
  void require(Action action, std::string_view what) const;
  TouchBackend& backend() { return *backend_; }
  const TouchBackend& backend() const { return *backend_; }
  /// Throws what went wrong with the follower, which has not followed since; ask once all else is saved.
  void checkFollower() const { relay_.checkFollower(); }
  /// What holds the frames of a depth camera and lets them go on; between runs, after finish(). Null where none are
  /// played.
  DepthPlayer* player() { return stream_ ? stream_->player.get() : nullptr; }
  /// What became of the frames of a depth camera, where the model is one. From any thread, but not beside
  /// releaseStream().
  std::optional<PlayCounts> playCounts() const;
  /// From where the newest of those was seen, where it says it. As playCounts().
  std::optional<PlayedView> playedView() const;
  /// Holds a depth camera at its present frame, at that time, and hands it on: the points stand still then, and a
  /// session whose Model::stream it is goes on behind the present frame, with a map that begins with its own cloud,
  /// once player() plays. Between runs. Null where none are played. Throws what a query could not.
  std::shared_ptr<PlayedStream> releaseStream(double time_s);
  /// Where others feel and sculpt the model, too; null where nobody does.
  SharedFollower* shared() { return shared_.get(); }
  const SharedFollower* shared() const { return shared_.get(); }
  /// Where the hands and cameras of others are, and this program's; null where it was not joined.
  SharedPresence* presence() const { return model_->presence.get(); }
  /// What brings the points around the hands, where somebody else has all of them, and how many ticks lacked some; null
  /// and none where all are here.
  FarCloud* far() const { return model_->far.get(); }
  UnknownTicks unknownTicks() const { return bricks_ ? bricks_->counts() : UnknownTicks{}; }
  /// Takes part in what others do until all of that, and all that was done here, is everywhere; at most so long.
  /// Whether it is. Between runs; without others at once. `known`: as the server was heard last, and where others go on
  /// for more than a second, until this hand's is taken and theirs so far is in effect here. `all`: asks the server, so
  /// that everything it had taken before this call is in effect here.
  enum class Settling { known, all };
  /// Around the hands alone: until what they have made has been taken.
  bool settleShared(double patience_s, Settling until = Settling::known);
  /// Before a session ends, between runs: waits until the server has all that was done here; at most so long, and for
  /// a server that is not heard no more than `unheard_s`. Whether it has; if not, the log says so.
  bool deliver(double patience_s = kSharedPatience_s, double unheard_s = kUnheard_s);
  /// Nothing where none is kept.
  Journal* journal() { return relay_.journal(); }
  EditRelay& relay() { return relay_; }

  /// Another brush, or none, from now on. Between runs.
  void setBrush(const std::optional<BrushConfig>& brush);
  /// What is felt, and how neighbours are found, from now on. Between runs.
  void setFeel(const SurfaceConfig& surface, const ForceOptions& force, const std::string& method);

  /// What governs a model that moves by itself; null where it does not.
  SimulationControl* simulation() const { return backend_->simulation(); }
  /// A parameter of a simulation, as SimulationControl::set() has it. Throws Error where nothing is simulated, too.
  void setParameter(std::string_view name, double value);

  /// Begins a session log, which says how the session goes from the model's file on. `hand`: the first one. Before a
  /// run, of whose options the rate and the clock are recorded. `onFault` hears at once, on the log's thread, what
  /// cannot be written; SessionRecording::takeFault() has it otherwise. Throws FileError, and Error where no journal is
  /// kept.
  void record(const std::string& file, const OpenHand& hand, RecordingFault onFault = {}, const RunOptions& run = {});
  SessionRecording* recording() const { return recording_.get(); }
  /// Ends the log: says how the session ended. Throws FileError where not all could be written.
  void endRecording();
  /// The same without an end, as that of a session that was cut off.
  std::unique_ptr<SessionRecording> releaseRecording();

  /// Plays the hands, the first of which may sculpt. In virtual time all edits are taken as they come; against the
  /// clock a thread of its own takes them. Throws UsageError for hands that do not go together.
  ServoResult run(std::span<const OpenHand> hands, const RunOptions& options);
  /// Waits for the last edit, and has everyone take in what was done; where others sculpt, too, that is everywhere
  /// then, or as long has passed as SessionParts says. Throws what a query could not.
  void finish();
  /// After finish(), or between runs: strokes of the points, or of the shape in which a soft body rests. Throws where
  /// the back end fails; the journal is as the points are then.
  UndoneStrokes undo(std::size_t strokes, std::size_t redo);
  /// The points as they are: as the journal knows them, where there is one and nothing moves.
  SculptedCloud sculpted() const;

  /// How old what is felt is, where somebody else has it; null elsewhere.
  const InformationAge* known() const;

  /// Longest of the hands' paths, unless the configuration says how long, s.
  double durationOf(std::span<const OpenHand> hands) const;

 private:
  void setSprings(std::span<const OpenHand> hands);
  std::unique_ptr<SharedFollower> takePart();
  bool settleFar(double patience_s);
  void awaitPoints(std::span<const OpenHand> hands, const RunOptions& options) const;

  const BackendKind& kind_;
  SessionConfig config_;
  std::shared_ptr<const Model> model_;
  SurfaceOptions surface_;
  std::shared_ptr<PlayedStream> stream_;  // where frames are played
  std::optional<FusedStream> fusion_;     // where they fuse
  std::unique_ptr<CloudSource> source_;   // where the back end does not do it itself
  bool isMoved_;                          // by somebody else's source
  std::unique_ptr<TouchBackend> backend_;
  std::unique_ptr<EditFollower> follower_;
  std::unique_ptr<SharedFollower> shared_;
  double sharedPatience_s_;
  Log* log_;
  BrickTouch* bricks_;  // the back end, where the points around the hands alone are here
  EditRelay relay_;
  std::unique_ptr<SessionRecording> recording_;
  double last_s_ = 0;  // of the ticks
};

}  // namespace palpate
