#pragma once

#include <atomic>
#include <future>
#include <optional>
#include <string>

#include "apps/view/commands.hpp"
#include "apps/view/settings.hpp"
#include "engine/core/clock.hpp"
#include "engine/select/point_bits.hpp"

namespace palpate {

/// Cleans the open model: a step of a preparation, or its normals. What that would drop is selected; new points, other
/// normals and another pose are one change. Computed on another thread, for the points as they are when it begins.
class CleanTask {
 public:
  CleanTask() = default;
  ~CleanTask() { cancel(); }
  CleanTask(const CleanTask&) = delete;
  CleanTask& operator=(const CleanTask&) = delete;

  /// `view`: how the model is shown. A large one is cleaned on the GPU of `context`, if that is a real one. Throws
  /// Error where another one is running, or the model refuses it.
  void begin(const WindowSession& session, const CleanModel& command, const ViewSettings& view, const Context& context);
  bool isRunning() const { return running_.valid(); }
  /// Ends it soon: follow() says so.
  void stop() { isStopped_ = true; }
  /// Ends it, and waits for its thread.
  void cancel();
  /// What it does, and for how long.
  std::string stage() const;
  /// Share that is done; empty: unknown.
  std::optional<double> share() const { return share_ < 0 ? std::nullopt : std::optional(share_.load()); }

  struct Done {
    std::string remark;
    bool isUpright = false;  ///< z is up now
  };
  /// Carries out what was found, once; called in each frame. Throws Error where points have changed since it began, and
  /// the failure of its thread.
  std::optional<Done> follow(WindowSession& session);

 private:
  struct Found {
    std::optional<PointBits> superfluous;
    PointSet points;  // of the action
    PointsAction action;
    Done done;
  };
  struct Given;
  static Found find(const Given& given);
  static Found findNormals(const Given& given);
  static Found findPose(const Given& given);
  static Found findHoles(const Given& given);
  static Found findSuperfluous(const Given& given);

  std::future<Found> running_;
  std::atomic<bool> isStopped_ = false;
  static constexpr double kUnknown = -1;
  std::atomic<double> share_ = kUnknown;
  CleanModel command_;
  Stopwatch since_;
  const WindowSession* session_ = nullptr;
  std::uint64_t edits_ = 0;  // of the session when it began
};

}  // namespace palpate
