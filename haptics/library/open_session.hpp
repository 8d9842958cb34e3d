// A session of the C interface, touched by path, tick by tick or live. Its parts have files of their own: BuiltSession
// (rebuilt for sculpting when the first brush is set), MovingFrames, SessionViews, PathTime, LiveHands and JoinedPart.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/library/built_session.hpp"
#include "haptics/library/claims.hpp"
#include "haptics/library/joined_part.hpp"
#include "haptics/library/live_hands.hpp"
#include "haptics/library/messages.hpp"
#include "haptics/library/moving_frames.hpp"
#include "haptics/library/session_views.hpp"

namespace palpate::library {

/// All calls but claims() and the last group require a claim of the calling thread: touch, look, or all, as marked.
class OpenSession {
 public:
  /// Throws Error.
  OpenSession(const Subject& subject, const pp_session_options& options, std::shared_ptr<Watch> watch);
  ~OpenSession();
  OpenSession(const OpenSession&) = delete;
  OpenSession& operator=(const OpenSession&) = delete;

  /// Ends the live session, the log and calls of the program's functions. The object stays valid for threads that still
  /// hold it. False: the server of a joined session has not confirmed all edits of this hand.
  bool end() noexcept;

  Claims& claims() { return claims_; }
  /// True between startLive() and stopLive(). For any thread.
  const std::atomic<bool>& goesOn() const { return goesOn_; }
  Watch& watch() { return *watch_; }
  /// Rebuilds the index after a call that was stopped while it did so.
  void ensureBuilt() { session_.ensure(); }
  /// Claim of a call that looks: without a budget the touching thread itself takes the edits in, so it needs all.
  Claim looking() const { return budget_us_ > 0 ? Claim::look : Claim::all; }
  const SessionConfig& config() const { return session_->config(); }
  const Model& model() const { return *model_; }
  std::size_t hands() const { return session_.opened().hands.size(); }
  /// Notified of each tick that a call returns.
  ContactEvents& events() { return events_; }

  // All.
  /// Each hand follows its path in virtual time, the first one with this brush or without one.
  ServoResult run(const std::vector<Path>& paths, const std::optional<BrushConfig>& brush);
  void setBrush(const std::optional<BrushConfig>& brush);
  void setContact(const SurfaceConfig& surface, const ForceOptions& force);
  std::size_t undo(std::size_t strokes) { return goBack(strokes, 0); }
  bool cancelStroke();
  std::size_t redo(std::size_t strokes) { return goBack(0, strokes); }
  /// Sets a mask, and copies one: a byte for each present point, in the order of points(). Throws UsageError,
  /// StateError.
  void setMask(MaskRole role, std::span<const std::uint8_t> mask);
  void copyMask(MaskRole role, std::span<std::uint8_t> mask);
  /// The same of the weights of locks.
  void setLockWeights(std::span<const std::uint8_t> weights);
  void copyLockWeights(std::span<std::uint8_t> weights);
  void softenLock(double radius_mm);
  /// Removes, paints or moves the points of such a mask; a movement is in coordinates of the file. Throws UsageError,
  /// StateError.
  void changePoints(std::span<const std::uint8_t> mask, PointsAction action);
  /// Makes the layer of strokes of that name, or opens it again; without a name none is open. Throws UsageError,
  /// StateError.
  void openLayer(std::optional<std::string_view> name);
  /// Sets one otherwise (Session::setStrokeLayer()). Throws likewise, also where there is none of that name.
  void setLayer(std::string_view name, bool continues, const std::function<void(StrokeLayer&)>& change);
  const StrokeLayers& layers();
  std::uint32_t layerNamed(std::string_view name);
  /// Throws NetworkError, which names `what`, if the server of a joined session has not confirmed it; not while live.
  void requireDelivered(std::string_view what) const {
    if (joined_ && !isLive()) joined_->requireDelivered(*session_, what);
  }
  PointCloud points();
  /// Records the next path, or the next live session, or from now on a live session, to this log. Throws StateError;
  /// the recorded call throws FileError.
  void record(const std::string& file);
  /// Session::settleShared(). Throws StateError while the session is live, and as joined() does.
  bool settleShared(double seconds);
  /// Session::saveAtServer(). Throws as joined() does.
  ServerSave saveAtServer(double seconds);
  void startLive(const pp_live_options& options);
  void stopLive();

  // Touch.
  /// One tick, with a pose for each hand. Throws UsageError for another number of poses, and what the program's contact
  /// function throws.
  void touch(std::span<const Pose> poses, std::span<pp_contact> contacts, double* torques_mNm);
  void lift();

  // Look.
  pp_session_info info() const;
  /// Takes in pending edits.
  void takeIn() { session_->catchUp(); }
  /// Throws NetworkError if this hand's part in a joined session has ended permanently.
  void checkShared() const;
  /// This and the three functions below throw StateError if the session was not joined.
  pp_sharing sharing() const { return joined().state(*session_); }
  std::vector<pp_other_hand> otherHands() const { return joined().otherHands(*session_); }
  std::vector<pp_other_camera> cameras() const { return joined().cameras(*session_); }
  /// Null: no camera. Throws UsageError for an invalid camera.
  void publishCamera(const pp_camera_place* camera) { joined().publishCamera(*session_, camera); }
  Image draw(const PictureRequest& request);
  Mesh mesh(const pp_mesh_options& options);
  /// Surface of the present points. Throws StateError if the session has none here.
  const SurfaceIndex& surfaceIndex();
  const SessionQueries& queries() const { return views_.queries(); }
  /// Where the present points come from. Throws StateError if they move.
  std::vector<pp_row> rows();
  /// Null before the first live session.
  LiveHands* live() { return live_ ? &*live_ : nullptr; }
  bool isLive() const { return live_ && live_->isRunning(); }
  /// Present frame of the moving points. Throws StateError if the points do not move.
  std::shared_ptr<const FrameObject> frame();
  /// Throws StateError if the session has no scene of matter.
  SimulationControl& simulation() const;
  void reset();
  void setParameter(std::string_view name, double value);
  pp_motion motion() const;

  // From any thread.
  /// Adds a frame, with positions in file coordinates. Throws UsageError, and StateError if the session does not take
  /// frames.
  void pushFrame(PointCloud cloud, std::vector<Vec3> velocities, double time_s) {
    frames_.push(std::move(cloud), std::move(velocities), time_s);
  }
  void setForces(bool on);
  /// What the program's force law has done wrong since the last call, in words.
  std::optional<std::string> takeLawFault();
  /// Warns of it.
  void reportLaw() {
    if (const auto fault = takeLawFault()) messages_.sink().warn("{}", *fault);
  }

 private:
  OpenSession(const Subject& subject, const pp_session_options& options, std::shared_ptr<Watch> watch,
              const SessionConfig& config);
  // Replaces the GPU by the CPU if that answers sooner, where the program leaves the choice to this library. Returns
  // the configuration with the one chosen.
  SessionConfig takeSooner(const Subject& subject, const pp_session_options& options, SessionConfig config);
  /// Throws StateError.
  void requireNotLive() const;
  /// Ends touching tick by tick.
  void endAsking();
  /// Takes in all edits and ends a recording; touching tick by tick goes on. Throws StateError while it is live.
  void settle();
  /// settle(), except while the session is live.
  void settleForCommand();
  void requireRecordable();
  void endRecording();
  std::size_t goBack(std::size_t undo, std::size_t redo);
  // True if the points move.
  bool moves() const { return session_.opened().moves() || frames_.pushed(); }
  // Newest frame of points that move; else null.
  std::shared_ptr<const FrameObject> frameIfMoving() { return moves() ? frame() : nullptr; }
  const JoinedPart& joined() const;
  bool leave();
  class OneCall;
  /// Session::finish(). What a call waits for other programs is JoinedPart::timeout_s() in all.
  void finish();
  double timeLeft_s() const;
  // Has the session follow its points, and with `edits` change them. Throws StateError, which names `what`.
  void keepPoints(Action action, std::string_view what, bool edits);
  // The points as a mask of that many bytes names them, once the session follows them.
  const PointStates& maskable(std::size_t bytes, bool edits);
  PointSet pointsOf(std::span<const std::uint8_t> mask, bool edits);
  void setBrushBetween(const std::optional<BrushConfig>& brush);
  ServoResult follow(const std::vector<Path>& paths);

  std::shared_ptr<Watch> watch_;
  Messages messages_;
  Claims claims_;
  double budget_us_;
  bool hasEnded_ = false;
  std::atomic<bool> forcesOn_ = true, goesOn_ = false;
  std::optional<BrushConfig> brush_;
  std::optional<Stopwatch> since_;  // of a call that waits several times
  NextLog nextLog_;
  PathTime time_;
  SessionViews views_;
  std::unique_ptr<BackendKind> backend_;
  std::optional<JoinedPart> joined_;
  std::shared_ptr<const Model> model_;
  ContactEvents events_;
  ForceFunction law_;
  MovingFrames frames_;
  BuiltSession session_;
  std::optional<LiveHands> live_;  // destroyed first
};

}  // namespace palpate::library
