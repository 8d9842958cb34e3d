// A session that is built for feeling only, and built again to be recorded or sculpted.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptics/library/joined_part.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/path.hpp"
#include "haptics/session/placed_clouds.hpp"
#include "haptics/session/session.hpp"

namespace palpate::library {

/// When the next path of a session begins, and which hands keep their contact until then.
/// Where points move, time continues from path to path; elsewhere each path begins at 0. All but askReset() for one
/// thread at a time.
class PathTime {
 public:
  /// Time of the next tick, s.
  double begin_s() const { return next_s_; }
  /// The path, which begins at 0, at that time.
  Path later(const Path& path) const;
  /// Whether a hand begins where it ended, and so keeps its contact.
  bool goesOn(std::size_t hand, const Path& path, const ModelScale& scale) const;

  /// The next path begins at 0.
  void restart();
  /// The same, once that path begins. For any thread.
  void askReset() { reset_ = true; }
  bool takeReset() { return reset_.exchange(false); }
  /// The hands have moved over points that move.
  void ended(const ServoResult& result, double tick_s);
  /// After a tick of pp_touch(): its contact does not continue in the next path.
  void ticked(double next_s);

 private:
  double next_s_ = 0;
  std::vector<DVec3> hips_;  // of each hand at the end of the last path
  std::atomic<bool> reset_ = false;
};

/// The log that the next path, or live session, is recorded to.
class NextLog {
 public:
  void set(const std::string& file) { file_ = file; }
  explicit operator bool() const { return file_.has_value(); }

  /// Begins to record, if a file was set. `log` receives what cannot be recorded, and must outlive the recording.
  void begin(Session& session, const OpenHand& hand, const RunOptions& run, Log& log) {
    if (!file_) return;
    const std::string file = *std::exchange(file_, std::nullopt);
    session.record(
        file, hand, [&log](const std::string& what) { log.warn("{}", what); }, run);
  }

 private:
  std::optional<std::string> file_;
};

/// What a session of the C interface is of, and how its options configure it.
/// Model of a session: points of the program, or else what `model` describes.
struct Subject {
  ModelConfig model;
  const PointCloud* cloud = nullptr;
  std::vector<PlacedCloud> clouds;          ///< several, instead of `cloud`
  std::optional<pp_frames_options> frames;  ///< points that the program moves frame by frame
  std::optional<JoinSubject> join;          ///< how this program takes part in the session that the model joins

  bool hasArrays() const { return cloud || !clouds.empty(); }
};

/// Throws UsageError for options that are out of bounds.
SessionConfig configFrom(const Subject& subject, const pp_session_options& options);

/// Throws Error, such as for a model without points.
Model modelFrom(const Subject& subject, const SessionConfig& config, const ModelLoading& loading);

class BuiltSession {
 public:
  struct Parts {
    SessionConfig config;  ///< as opened
    std::shared_ptr<const Model> model;
    const BackendKind& backend;
    unsigned threads = 0;
    double sharedPatience_s = kSharedPatience_s;
    Log& log;
    CloudSource* source = nullptr;
    FollowerMaker follower;         ///< receives all edits
    std::function<void()> forgets;  ///< called before another session replaces this one
  };
  /// The pointees must outlive this. Nothing is built yet.
  explicit BuiltSession(Parts parts) : parts_(std::move(parts)) {}

  /// With a history of the points if it is to be recorded, and for all kinds of brushes if it is to be edited. Restores
  /// the previous session if the new one cannot be built; a stopped call leaves that to ensure(). Throws Error,
  /// Stopped.
  void build(bool keepsPoints, bool editable);
  /// Builds the session that a stopped call has left to be restored.
  void ensure();

  /// False between a stopped call and ensure().
  explicit operator bool() const { return session_ != nullptr; }
  Session& operator*() const { return *session_; }
  Session* operator->() const { return session_.get(); }

  const SessionConfig& opened() const { return parts_.config; }
  const Model& model() const { return *parts_.model; }
  /// Takes a brush without being built again; else the session refuses one with a reason.
  bool isEditable() const { return editable_; }
  bool hasFailed() const { return session_->simulation() && !session_->simulation()->failure().empty(); }

 private:
  void make(SessionConfig config, bool keepsPoints, bool editable);

  Parts parts_;
  bool editable_ = false;
  struct Before {
    SessionConfig config;
    bool keepsPoints, editable;
  };
  std::optional<Before> before_;  // to be built by ensure(), if session_ is null
  std::unique_ptr<Session> session_;
  std::optional<PulledState> pulled_;  // of a session that is being replaced
};

}  // namespace palpate::library
