// A session as the C interface has it: felt first, sculpted once somebody wants that, touched by path, tick by tick or
// live.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "haptics/library/claims.hpp"
#include "haptics/library/force_function.hpp"
#include "haptics/library/gpu_half.hpp"
#include "haptics/library/joined_part.hpp"
#include "haptics/library/live_hands.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/library/pushed_frames.hpp"
#include "haptics/library/remarks.hpp"
#include "haptics/session/asked_hands.hpp"
#include "haptics/session/session.hpp"

namespace palpate::library {

/// What a session is of: points, or a scene of matter.
struct Subject {
  ModelConfig model;  ///< with the name of its file
  const PointCloud* cloud = nullptr;
  std::optional<MatterScene> scene;
  std::optional<StreamConfig> stream;       ///< a recorded depth camera, in the model's folder
  std::optional<pp_frames_options> frames;  ///< whose points a program moves, frame by frame
  std::optional<JoinSubject> join;          ///< that another program serves, by the model's name
};

/// Every call but claims() and setForces() is for a thread that holds what it says: touch, look, or all.
class OpenSession {
 public:
  /// Throws Error.
  OpenSession(const Subject& subject, const pp_session_options& options, std::shared_ptr<Watch> watch);
  ~OpenSession();
  OpenSession(const OpenSession&) = delete;
  OpenSession& operator=(const OpenSession&) = delete;

  /// No hand is driven, and no function of the program called, from then on; whoever holds it still finds it as it is.
  void end() noexcept;

  Claims& claims() { return claims_; }
  Watch& watch() { return *watch_; }
  /// Builds the index again after a call that was stopped while it did.
  void ensureBuilt();
  /// What a call that looks has to hold: without a budget the thread that touches takes edits in itself.
  Claim looking() const { return budget_us_ > 0 ? Claim::look : Claim::all; }
  const SessionConfig& config() const { return session_->config(); }
  const Model& model() const { return *model_; }
  std::size_t hands() const { return config_.hands.size(); }

  // All.
  /// Each hand follows its path in virtual time, the first one with that brush or without any.
  ServoResult run(const std::vector<Path>& paths, const std::optional<BrushConfig>& brush);
  void setBrush(const std::optional<BrushConfig>& brush);
  void setFeel(const SurfaceConfig& surface, const ForceOptions& force);
  std::size_t undo(std::size_t strokes) { return goBack(strokes, 0); }
  std::size_t redo(std::size_t strokes) { return goBack(0, strokes); }
  PointCloud points();
  /// The next path, or the next live session, goes into this log. Throws StateError, FileError once it begins.
  void record(const std::string& file);
  /// Session::settleShared(). Throws StateError while it is live, and as joined().
  bool settleShared(double seconds);
  void startLive(const pp_live_options& options);
  void stopLive();

  // Touch.
  /// A pose for each hand. Throws UsageError for another number of them.
  std::span<const AskedTick> touch(std::span<const Pose> poses);
  void lift();

  // Look.
  pp_session_info info() const;
  /// Takes in what was done to the points.
  void takeIn();
  /// Throws NetworkError where this hand's part in a session of others has ended for good.
  void checkShared() const;
  /// Both throw StateError where it was not joined.
  pp_sharing sharing() const { return joined().state(*session_); }
  std::vector<pp_other_hand> others() const { return joined().others(*session_); }
  std::vector<pp_other_camera> cameras() const { return joined().cameras(*session_); }
  /// Null: none. Throws UsageError for what is none.
  void showCamera(const pp_camera_place* camera) { joined().showCamera(*session_, camera); }
  Image draw(const PictureRequest& request);
  Mesh mesh(const pp_mesh_options& options);
  /// Null before the first one.
  LiveHands* live() { return live_ ? &*live_ : nullptr; }
  bool isLive() const { return live_ && live_->isRunning(); }
  /// The points of what moves, as they are. Throws StateError where nothing does.
  std::shared_ptr<const FrameObject> frame();
  /// Throws StateError where nothing moves by itself.
  SimulationControl& simulation() const;
  void reset();
  void setParameter(std::string_view name, double value);
  pp_motion motion() const;

  // From any thread.
  /// Positions in file coordinates. Throws UsageError, and StateError where no frames are brought.
  void pushFrame(PointCloud cloud, std::vector<Vec3> velocities, double time_s);
  void setForces(bool on) { forcesOn_ = on; }

 private:
  class Followers;
  /// What was asked for tick by tick ends. Throws StateError while it is live.
  void endAsking();
  /// The same, and all that was done is taken in.
  void settle();
  // With a journal where it is to be logged, and for brushes of any kind where it is to be edited.
  void build(bool journal, bool editable);
  void make(SessionConfig config, bool journal, bool editable);
  void beginRecording(const OpenHand& hand, const RunOptions& run);
  void endRecording();
  std::size_t goBack(std::size_t undo, std::size_t redo);
  // The points do not stand still.
  bool moves() const { return config_.moves() || frames_; }
  const JoinedPart& joined() const;
  void leave();
  bool hasFailed() const { return session_->simulation() && !session_->simulation()->failure().empty(); }
  void setBrushBetween(const std::optional<BrushConfig>& brush);
  void requireRunning() const;
  bool goesOn(std::size_t hand, const Path& path) const;
  // How many points at the end are of what stands in the scene.
  std::size_t standing() const;
  bool takeFrame();
  // The points as they are; where they move, as the newest frame has them.
  PointCloud present();

  std::shared_ptr<Watch> watch_;
  Remarks remarks_;
  Claims claims_;
  SessionConfig config_;  // as it was opened
  unsigned threads_;
  double budget_us_;
  std::atomic<bool> forcesOn_ = true;
  std::uint64_t edits_ = 0;
  std::optional<BrushConfig> brush_;
  bool editable_ = false;
  struct Built {
    SessionConfig config;
    bool journal, editable;
  };
  std::optional<Built> unbuilt_;  // where there is no session_
  bool hasLaw_ = false;
  std::optional<std::string> recordTo_;  // what runs next
  double next_s_ = 0;                    // where the time of what moves has come to, for the next path
  std::vector<DVec3> hips_;              // of the hands, where a path has left them
  std::atomic<bool> reset_ = false;      // the next path begins at 0
  bool framesGoOn_ = false;              // in the time of a live session
  GpuHalf gpu_;
  std::unique_ptr<BackendKind> backend_;
  std::optional<JoinedPart> joined_;
  std::shared_ptr<const Model> model_;
  ForceFunction law_;
  std::shared_ptr<const FrameObject> frame_;  // the newest one
  std::unique_ptr<PushedFrames> frames_;      // where a program brings them
  std::unique_ptr<Session> session_;
  std::optional<AskedHands> asked_;
  std::optional<LiveHands> live_;  // goes first
};

}  // namespace palpate::library
