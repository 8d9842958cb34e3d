// A session as the C interface has it: felt first, sculpted once somebody wants that, touched by path, tick by tick or live.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptics/library/claims.hpp"
#include "haptics/library/force_function.hpp"
#include "haptics/library/gpu_half.hpp"
#include "haptics/library/live_hand.hpp"
#include "haptics/session/asked_hand.hpp"
#include "haptics/session/session.hpp"

namespace palpate::library {

/// Passes remarks on.
class Remarks final : public LogListener {
 public:
  Remarks(pp_log_function log, void* user) : log_(log), user_(user) {
    if (log) sink_.listen(this);
  }
  Log& sink() { return sink_; }
  void said(std::string_view line) override { log_(user_, std::string(line).c_str()); }
  void progressed(std::string_view, double) override {}

 private:
  pp_log_function log_;
  void* user_;
  Log sink_{true};
};

/// Every call but claims() and setForces() is for a thread that holds what it says: touch, look, or all.
class OpenSession {
 public:
  /// Throws Error.
  OpenSession(const PointCloud& cloud, const pp_session_options& options);
  ~OpenSession();
  OpenSession(const OpenSession&) = delete;
  OpenSession& operator=(const OpenSession&) = delete;

  Claims& claims() { return claims_; }
  /// What a call that looks has to hold: without a budget the thread that touches takes edits in itself.
  Claim looking() const { return budget_us_ > 0 ? Claim::look : Claim::all; }
  const SessionConfig& config() const { return session_->config(); }
  const Model& model() const { return *model_; }

  // All.
  /// Follows a path in virtual time, with that brush or without any.
  ServoResult run(Path path, const std::optional<BrushConfig>& brush);
  void setBrush(const std::optional<BrushConfig>& brush);
  void setFeel(const SurfaceConfig& surface, const ForceOptions& force);
  std::size_t undo(std::size_t strokes) { return goBack(strokes, 0); }
  std::size_t redo(std::size_t strokes) { return goBack(0, strokes); }
  PointCloud points();
  void startLive(const pp_live_options& options);

  // Touch.
  AskedTick touch(const Pose& pose);
  void lift();

  // Look.
  pp_session_info info() const;
  /// Takes in what was done to the points.
  void takeIn();
  Image draw(const PictureRequest& request);
  Mesh mesh(const pp_mesh_options& options);
  /// Null before the first one.
  LiveHand* live() { return live_ ? &*live_ : nullptr; }
  bool isLive() const { return live_ && live_->isRunning(); }

  // From any thread.
  void setForces(bool on) { forcesOn_ = on; }

 private:
  class Followers;
  /// Throws StateError while it is live; what was asked for tick by tick ends, and all that was done is taken in.
  void settle();
  void build(bool editable);
  std::size_t goBack(std::size_t undo, std::size_t redo);

  Remarks remarks_;
  Claims claims_;
  SessionConfig config_;  // as it was opened
  unsigned threads_;
  double budget_us_;
  std::atomic<bool> forcesOn_ = true;
  std::uint64_t edits_ = 0;
  std::optional<BrushConfig> brush_;
  GpuHalf gpu_;
  std::unique_ptr<BackendKind> backend_;
  std::shared_ptr<const Model> model_;
  ForceFunction law_;
  std::unique_ptr<Session> session_;
  std::optional<AskedHand> asked_;
  std::optional<LiveHand> live_;  // goes first
};

}  // namespace palpate::library
