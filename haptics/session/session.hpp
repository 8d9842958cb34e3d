// A session: a model, a back end and the followers of the edits, combined once for every program.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/edit/points_action.hpp"
#include "haptics/servo_loop.hpp"
#include "haptics/session/abilities.hpp"
#include "haptics/session/backends.hpp"
#include "haptics/session/command_channel.hpp"
#include "haptics/session/edit_relay.hpp"
#include "haptics/session/far_touch.hpp"
#include "haptics/session/hand_source.hpp"
#include "haptics/session/live_run.hpp"
#include "haptics/session/moving_model.hpp"
#include "haptics/session/pulled_hands.hpp"
#include "haptics/session/scene.hpp"

namespace palpate {

/// Creates the follower of a session's edits once the back end has been made.
using FollowerMaker = std::function<std::unique_ptr<EditFollower>(const Model& model, TouchBackend& backend)>;

/// Default maximum time that a session waits until its own edits and those of others are in effect everywhere.
inline constexpr double kSharedPatience_s = 10;
/// Wait for a server that is to write its file.
inline constexpr double kServerSave_s = 30;
/// Default maximum time that an ending session waits for a silent server.
inline constexpr double kUnheard_s = 5;

/// Arguments of a session beside its configuration.
struct SessionParts {
  const BackendKind& backend;
  unsigned threads = 0;      ///< on the CPU; 0: one per core
  bool keepsPoints = false;  ///< follows the edits of points, for undo, saving and logs, if the back end reports them
  UndoBudget undo;
  bool paintable = false;  ///< keeps colours for a later brush
  /// Maximum time that run() and finish() wait for the others, if the model is shared.
  double sharedPatience_s = kSharedPatience_s;
  /// Receives messages about frames that are not fused into the map of a depth camera, and about strokes that were not
  /// delivered; must outlive the session.
  Log* log = nullptr;
  /// Moves the points, if the configuration does not; must outlive the session. Null: nothing moves them.
  CloudSource* source = nullptr;
  std::vector<FollowerMaker> followers;  ///< beside the history and the log
  EngineChoices engine;                  ///< of benches
};

/// Options of a run beside the configuration. All pointees must outlive it.
struct RunOptions {
  double begin_s = 0;                       ///< the time of the first tick
  double rate_Hz = 0;                       ///< ticks per second; 0: as the configuration says
  bool endless = false;                     ///< against the wall clock until `stop`
  SteppedClock* clock = nullptr;            ///< in place of the machine's (ServoOptions::clock)
  const std::atomic<bool>* stop = nullptr;  ///< ends the run when it becomes true; null: the flag of the job (JobStop)
  const std::atomic<bool>* forcesOn = nullptr;  ///< no force while it is false (ServoOptions::forcesOn)
  TickRecorder* recorder = nullptr;             ///< notified of each tick
  TickObserver observer;                        ///< after each tick in virtual time
  ContactQuery* query = nullptr;                ///< asked in place of the back end, to which it forwards
  bool realtime = false;                        ///< against the wall clock, regardless of the configuration
  TickHook before;                              ///< before each tick in virtual time; may give commands
  /// Continues as the recorded session: the content of LoggedCommand::Kind::begin.
  std::string resume;
  CustomForce law;  ///< of the first hand, in place of spring and damper (ForceLaw)
};

/// The present points, edits included.
struct SculptedCloud {
  PointCloud cloud;
  std::size_t edited = 0;  ///< points that are moved, recoloured, removed or new, compared with the file
  std::string remark;      ///< that these are not all points, in words; empty: they are
};

/// A model that hands touch: *run* along paths, in virtual time or against the clock; *live*, on a servo thread of its
/// own without end; or *pulled*, tick by tick, by the host program. Commands (brush, surface, undo, frames, recording)
/// take effect between two ticks. The loop of a live session goes on: while a command works on the points, each hand
/// keeps the planes that it felt last (LendableQuery). Other devices, and a pause, end its thread.
///
/// For one thread at a time, which also takes the edits, unless stated otherwise.
class Session {
 public:
  /// Builds the index. `model` has points and normals; sessions may share it. Throws Error, ConfigError.
  Session(SessionConfig config, std::shared_ptr<const Model> model, const SessionParts& parts);
  Session(SessionConfig config, Model model, const SessionParts& parts);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // What it is made of.

  const SessionConfig& config() const { return config_; }
  const Model& model() const { return *scene_.layers[0].model; }
  const SessionScene& scene() const { return scene_; }
  /// As felt, model units.
  const SurfaceOptions& surface() const { return surface_; }
  std::string method() const { return kind_.methodOf(config_.backend); }
  /// Name of the answering machine. Thread-safe.
  const std::string& machine() const { return machine_; }
  /// The actions that the model allows, and the reason for each refusal.
  Abilities abilities() const;
  /// Throws Error "WHAT: the refusal" where the model or the back end refuses the action.
  void require(Action action, std::string_view what) const;
  TouchBackend& backend() const { return *backend_; }
  /// What brushes could not do so far. Thread-safe.
  BlockedMoves blocked() const noexcept { return backend_->edits() ? backend_->edits()->blocked() : BlockedMoves{}; }
  /// Ticks of its back end that were bridged so far. Thread-safe.
  BridgedTicks bridged() const noexcept { return backend_->bridged(); }
  /// Controls the simulation of the model; null if it is not simulated. Thread-safe.
  SimulationControl* simulation() const { return backend_->simulation(); }
  /// What was changed; null if nothing is followed.
  History* history() { return relay_.history(); }
  const History* history() const { return relay_.history(); }
  /// The same; null also if it does not follow the points (SessionParts::keepsPoints), or not all of them (far()).
  const History* pointHistory() const { return relay_.keepsPoints() && !farTouch_ ? relay_.history() : nullptr; }

  // Run: along paths.

  /// Plays the hands, the first of which may sculpt. In virtual time edits are taken between ticks; against the clock a
  /// thread of its own takes them. Throws UsageError for incompatible hands.
  ServoResult run(std::span<const OpenHand> hands, const RunOptions& options);
  /// Waits for the last edit and lets all followers take the edits; if others sculpt, too, also until the edits are in
  /// effect everywhere, at most SessionParts::sharedPatience_s. Throws errors of earlier queries.
  void finish();
  /// Replaces SessionParts::sharedPatience_s, for a call that waits several times.
  void setSharedPatience(double timeout_s) { sharedPatience_s_ = timeout_s; }
  /// Lets the followers take the edits so far. Throws what taking them throws.
  void catchUp() { relay_.catchUp(); }
  /// Ends the thread that takes the edits; the history stays as it is, edits may be missing.
  void abandonEdits() { relay_.stop(); }
  /// Edits taken last, if there is a history.
  const EditBatch& lastEdits() const { return relay_.batch(); }
  /// Throws the failure of a follower, which has not followed since; call it once everything else is saved.
  void checkFollower() const { relay_.checkFollower(); }
  /// Duration of the longest path of the hands, unless the configuration gives one, s.
  double durationOf(std::span<const OpenHand> hands) const;

  // Live: on a servo thread of its own.

  /// Begins. All hands must outlive the live session. Ticks of an earlier one that were not taken are dropped.
  void start(std::vector<OpenHand> hands, const LiveRunOptions& options);
  /// Ends: waits for the tick in progress; the devices have no force then. Its ticks can still be taken.
  void stop();
  /// Not stopped, and not ended by a fault. Thread-safe, except during start().
  bool isLive() const { return live_ && !live_->hasEnded(); }
  /// The live session: its ticks, and why it has ended. Null before the first. Its ticks can be taken while a pointer
  /// to it is kept, also after this session.
  const std::shared_ptr<LiveRun>& live() const { return live_; }
  /// Pauses a live session between two ticks and takes its edits, so that another session may use the same GPU queues
  /// and devices. It stays paused if that throws.
  void pause();
  /// After pause(): continues, unless it has ended by a fault.
  void resume();
  /// Starts the servo thread again, one tick after the last, also after a fault.
  void restart() { live_->resume(); }
  /// Calls `act` between two ticks, with all edits taken and the stroke ended; a loop in progress goes on meanwhile
  /// (CommandChannel::Loan).
  template <class Act>
  auto between(Act&& act) {
    const CommandChannel::Loan loan(channel_);
    return act();
  }
  /// Calls `act` while the session is paused: its loop begins again, with other hands or another time.
  template <class Act>
  void restarted(Act&& act) {
    const bool wasLive = live_ && live_->pause();
    std::exception_ptr failure;
    try {
      if (wasLive) takeEdits();
      act();
    } catch (...) {
      failure = std::current_exception();
    }
    if (wasLive) resume();
    if (failure) std::rethrow_exception(failure);
  }
  /// The time of a live session's next tick. In between(), or while it is paused.
  double next_s() const { return channel_.isLent() ? channel_.next_s() : live_->next_s(); }

  // Pulled: tick by tick.

  /// Begins: tick() answers from now on. Throws as TouchBackend::begin() does.
  void pull(const PullOptions& options);
  bool isPulled() const { return pulled_.has_value(); }
  /// PulledHands::isLater(); true if the next pose begins new contacts.
  bool isLater(double time_s) const noexcept { return !pulled_ || pulled_->isLater(time_s); }
  /// Takes a pose for each hand, all of the same time; the result is valid until the next call. Allocates nothing
  /// unless points are edited. On any fault the force is zero and the contact invalid.
  std::span<const PulledTick> tick(std::span<const Pose> poses) noexcept {
    PALPATE_CHECK(pulled_);
    return pulled_->tick(poses);
  }
  /// Lifts all hands; the next poses put them down elsewhere.
  void lift() noexcept {
    if (pulled_) pulled_->lift();
  }
  /// Begins as the session whose state this is, with its contacts and forces. Throws Error for other tools.
  void resumePulling(PulledState state);
  /// Empty unless it is pulled. After finish(). Throws errors of earlier queries.
  std::optional<PulledState> pulledState() const { return pulled_ ? std::optional(pulled_->state()) : std::nullopt; }
  /// Before a command, with which it goes on. Ends if taking edits has failed, and throws that failure.
  void checkPulling();
  /// Ends. Throws the failure of taking edits, if there was one.
  void endPulling();

  // Commands.

  /// Replaces or removes the brush.
  void setBrush(const std::optional<BrushConfig>& brush);
  /// Replaces the surface, the force and the method of the neighbour search.
  void setContact(const SurfaceConfig& surface, const ForceOptions& force, const std::string& method);
  /// Sets a parameter of the simulation, as SimulationControl::set() does. Throws Error also if nothing is simulated.
  void setParameter(std::string_view name, double value);
  /// What the session does with a depth camera's frames.
  enum class Frames { play, pause, step };
  /// Between ticks. No effect where no frames are played.
  void setFrames(Frames frames);
  /// Sets a mask of the points, until undo(). Threads and times as for undo(). Throws Error where the model refuses it,
  /// or the points are not followed.
  void setMask(MaskRole role, const PointSet& points);
  /// Weights of the points' locks, by number, of PointLock::kWhole; and sets them, as one change: as a mask while all
  /// points are wholly locked or free, and as the field kLockField from the first other weight on. Points behind the
  /// end of `weights` get those of their parents.
  std::vector<std::uint8_t> lockWeights() const;
  /// Number of points that a field of the file locks, also in part.
  std::size_t lockedByFile() const;
  void setLockWeights(std::span<const std::uint8_t> weights);
  /// Number of the field of that name. The first call makes it, of the file's property or with zeros, until undo();
  /// throws as setMask().
  std::uint32_t fieldNamed(std::string_view name, ScalarType type = ScalarType::f32);
  /// Sets values of the field: one for each of the points, ascending, in native byte order. Otherwise as setMask();
  /// throws Error also if a point has no number yet, or values are missing.
  void setField(std::uint32_t field, const PointSet& points, std::vector<std::byte> values);
  /// The same of the field of that name, which is made if it is missing (fieldNamed()): one change in either case.
  /// Throws Error also if the field has another type.
  void setField(std::string_view name, ScalarType type, const PointSet& points, std::vector<std::byte> values);
  /// Makes the layer of strokes of the next number, or sets one otherwise, until undo(). `isOpen`: strokes become part
  /// of it, and of no other; its strength is 1 then. `continues`: the slide of its strength is part of the entry of the
  /// slide before, if that is the last one. Throws as setMask(), and for a layer that is merged, or a strength out of
  /// bounds.
  void setStrokeLayer(std::uint32_t number, StrokeLayer set, bool isOpen, bool continues = false);
  /// Removes those of the points that exist, paints or moves them, as one stroke; or SetPoints, whatever the set.
  /// Throws as setMask(), and for an action that validate() refuses; then nothing has changed.
  void changePoints(const PointSet& points, const PointsAction& action);
  /// Makes one of these changes as a log contains it. Throws Error also if it does not fit (LayerAttributes::fits()).
  void change(AttributeChange change);
  /// Repeats a command of a session log.
  void repeat(const LoggedCommand& command);
  /// After finish(), or live: undoes and redoes strokes of the points or of the rest shape of a soft body, and changes
  /// of masks and fields, in the order in which they were made. Throws if the back end fails; the history then matches
  /// the points.
  UndoneStrokes undo(std::size_t strokes, std::size_t redo);
  /// Takes the stroke in progress back, to the bit, as if it had never been made: it cannot be redone, and the hand
  /// makes no other before it has left the surface, or has released its button. False where none is in progress.
  /// `rest`: called while the loop works with the planes felt last, also if there is none. Throws as undo(), and Error
  /// for a stroke larger than the memory for undo, which stays.
  bool cancelStroke(const std::function<void()>& rest = {});
  /// Strokes of the points, or of that shape; zeros without a history.
  StrokeCounts strokes() const;
  /// The present points: from the history, if there is one and nothing moves, else from the back end, between ticks.
  SculptedCloud sculpted() const;
  /// Begins with recorded edits of the model, undone ones included. Before the first query.
  void followAgain(const EditBatch& edits);
  /// EditRelay::attributeHistory(). In between(), or before and after a run. Empty if no masks and fields are kept.
  EditBatch attributeHistory();

  /// Begins a session log: before a run, with its rate and clock as in `run`; or in a live session, in contact or not,
  /// whose points have not been edited. `hand`: the first one. `onFault` is called at once, on the log's thread, with
  /// what cannot be written; without it SessionRecording::takeFault() returns that. Throws FileError, and Error if no
  /// history is kept.
  void record(const std::string& file, const OpenHand& hand, RecordingFault onFault = {}, const RunOptions& run = {});
  SessionRecording* recording() const { return channel_.recording(); }
  /// How the log ends: checksum of the present points, masks and fields.
  std::uint64_t endChecksum() const {
    return checksumOf(model().cloud.origin, history()->points(), scene_.layers[0].attributes);
  }
  /// Ends the log and records how the session ended. Throws FileError if not everything could be written, unless
  /// SessionRecording::takeFault() has said so.
  void endRecording();
  /// Ends the log without recording an end, as if the session had been interrupted.
  void abandonRecording() { releaseRecording(); }

  // The frames of a depth camera, if the model is one.

  /// Pauses and resumes the frames; between ticks, after finish(). Null if no frames are played.
  DepthPlayer* player() const { return stream_ ? stream_->player.get() : nullptr; }
  /// Counts of the frames. Thread-safe, but not during releaseStream().
  std::optional<PlayCounts> playCounts() const;
  /// View of the newest of those frames, if it has a pose. Threads as for playCounts().
  std::optional<PlayedView> playedView() const;
  /// Pauses a depth camera at its present frame, at that time, and hands it on: the points stand still then. A session
  /// that has it as its Model::stream continues behind that frame, with a map that begins with its own cloud, once
  /// player() plays. Between ticks. Null if no frames are played. Throws errors of earlier queries.
  std::shared_ptr<PlayedStream> releaseStream(double time_s);

  // Others who feel and sculpt the model.

  /// Exchange of edits with them; null if the model is not shared.
  SharedFollower* shared() const { return shared_.get(); }
  /// Hands and cameras of the others and of this program; null if the model was not joined.
  SharedPresence* presence() const { return model().presence(); }
  /// Fetches the points around the hands, if another program has all of them, and the ticks that lacked some; null and
  /// zero if all points are here.
  FarCloud* far() const { return model().far(); }
  UnknownTicks unknownTicks() const { return farTouch_ ? farTouch_->counts() : UnknownTicks{}; }
  /// Age of the information about the surface, if another program has it; else null.
  const InformationAge* known() const;
  /// `known`: judges by the last message received from the server. If others edit for more than a second, it suffices
  /// that the server has accepted this hand's edits and that theirs so far are in effect here. `all`: asks the server,
  /// so that everything it had accepted before this call is in effect here.
  enum class Settling { known, all };
  /// Exchanges edits with the others until all of theirs and of this hand's are in effect everywhere, at most
  /// `timeout_s`. Returns whether they are. Between runs. With far(): until the server has accepted this program's
  /// edits.
  bool settleShared(double timeout_s, Settling until = Settling::known);
  /// Before a session ends, between runs: waits until the server has accepted all edits of this program, at most
  /// `timeout_s`, and at most `unheard_s` while the server is silent. Returns whether it has; if not, logs it.
  bool deliver(double timeout_s = kSharedPatience_s, double unheard_s = kUnheard_s);

  /// Of a joined session that can be sculpted: asks the server to write its file, once it has accepted the edits that
  /// have been taken in here, and waits for its answer, at most `timeout_s`, and not while it is silent. Nothing for
  /// other models. For any thread.
  std::optional<ServerSave> saveAtServer(double timeout_s = kServerSave_s) const;

 private:
  std::unique_ptr<TouchBackend> makeTouch(const SessionParts& parts);
  std::vector<std::unique_ptr<EditFollower>> make(const std::vector<FollowerMaker>& makers) const;
  std::vector<EditFollower*> followers() const;
  std::vector<HandSpring> springs(std::span<const OpenHand> hands) const;
  std::unique_ptr<SharedFollower> takePart();
  std::unique_ptr<SessionRecording> releaseRecording();
  PulledParts pulledParts(const PullOptions& options);
  void takeEdits();
  std::string textFor(const SessionConfig& config) const;
  const LayerAttributes& attributesFor(Action action, std::string_view what) const;
  void logAttributes(SessionWriter& log, const EditBatch& past);
  bool settleFar(double timeout_s);
  void awaitPoints(std::span<const OpenHand> hands, const RunOptions& options) const;

  const BackendKind& kind_;
  SessionConfig config_;
  SessionScene scene_;
  SurfaceOptions surface_;
  std::shared_ptr<PlayedStream> stream_;  // if frames are played
  std::optional<FusedStream> fusion_;     // if they are fused
  std::unique_ptr<CloudSource> source_;   // if the back end does not move the points itself
  bool isMoved_;                          // by SessionParts::source
  FarTouch* farTouch_ = nullptr;          // the back end, if only the points around the hands are here
  std::unique_ptr<TouchBackend> backend_;
  std::string machine_;
  std::vector<std::unique_ptr<EditFollower>> followers_;
  std::unique_ptr<SharedFollower> shared_;
  double sharedPatience_s_;
  Log* log_;
  EditRelay relay_;
  CommandChannel channel_;
  SessionConfig built_;  // with which the back end was made
  bool isPaintable_;
  double last_s_ = 0;  // time of the last tick of a run
  std::optional<PulledHands> pulled_;
  std::shared_ptr<LiveRun> live_;  // destroyed first
};

}  // namespace palpate
