// Hands on a cloud of which only the bricks around them are loaded: they feel and sculpt only where points are known.
#pragma once

#include <atomic>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/touch_backend.hpp"
#include "engine/motion/brick_source.hpp"
#include "engine/touch/brick_sculptor.hpp"

namespace palpate {

struct BrickTouchOptions {
  double radius = 0;                       ///< support radius of the surface, model units
  double widening = 1;                     ///< factor on the radius for noisy points; edits use the unwidened radius
  double tool = 0;                         ///< distance from a hand to the farthest point of its tool
  DVec3 origin{0};                         ///< of the cloud
  double patience_s = 10;                  ///< timeout of virtual time, which waits for unknown points
  std::optional<BrushOptions> brush = {};  ///< of the first hand
  std::string fixed = {};                  ///< error text if the points cannot be sculpted; empty: they can
};

/// Wraps the back end that feels the points of a BrickSource, and sculpts them: it sends the source the positions of
/// the hands, and passes an answer on only if all points that it may depend on are known. Elsewhere the hand feels
/// nothing, its tick counts as one without data, and the hand is reset when points are known again. Against the clock
/// no tick waits; in virtual time each tick waits for its points, so that it is answered as if the whole cloud were
/// loaded.
class BrickTouch final : public TouchBackend {
 public:
  /// `surface` feels the points of `source`, which must outlive it.
  BrickTouch(BrickSource& source, std::unique_ptr<TouchBackend> surface, const BrickTouchOptions& options);

  /// For any thread.
  UnknownTicks counts() const noexcept { return {.ticks = ticks_.load(), .without = without_.load()}; }
  /// Before the first tick: waits up to `patience_s` for the points around these hands. Returns whether they are known.
  bool awaitAt(double time_s, std::span<const DVec3> hips, double patience_s);

  std::size_t hands() const noexcept override { return surface_->hands(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void prepare() noexcept override { surface_->prepare(); }
  void setRealtime(bool realtime) override { surface_->setRealtime(realtime); }
  std::span<const PointContact> points(std::size_t hand) const noexcept override { return hands_[hand].points; }
  void resetHand(std::size_t hand) noexcept override;
  /// Throws Error if virtual time ran into its timeout.
  void finish() override;
  /// Reads back only the loaded points; returns the number of all points that a hand here has changed.
  std::size_t readBack(PointCloud& cloud) const override;
  bool takeFrame(CloudFrame& frame) override { return surface_->takeFrame(frame); }
  FramePipeline* framesOn(const Device& sight) override { return surface_->framesOn(sight); }
  std::optional<PointsTime> pointsTime() const noexcept override { return surface_->pointsTime(); }

  bool keepsEdits() const override { return true; }
  void keepEdits() override {}
  void takeEdits(EditBatch&) override {}
  EditScope editScope() const override { return surface_->editScope(); }
  /// Throws UsageError if the points cannot be sculpted.
  void setBrush(const std::optional<BrushOptions>& brush) override;
  void setContact(SurfaceKind surface, double friction, std::string_view method) override {
    surface_->setContact(surface, friction, method);
  }

  std::string machine() const override { return surface_->machine(); }
  double buildTime_us() const override { return surface_->buildTime_us(); }
  const std::vector<double>& editTimes_us() const override { return sculptor_.statistics().editTimes_us; }
  std::span<const double> bridgeTimes_us() const override { return surface_->bridgeTimes_us(); }
  std::optional<double> firstEditTime_s() const override { return sculptor_.statistics().firstEditTime_s; }
  EditCosts editCosts() const override { return {.requests_us = {}, .states = sculptor_.states()}; }
  const TouchShortfalls& shortfalls() const override;
  IndexWork indexWork() const override { return surface_->indexWork(); }
  BackendMemory memory() const override { return surface_->memory(); }
  std::vector<PassRecord> passes() const override { return surface_->passes(); }
  double cell() const override { return surface_->cell(); }

 private:
  struct Hand {
    std::optional<DVec3> hip, proxy;   // at the last tick with known points
    std::vector<PointContact> points;  // as returned by points()
  };
  HandReach reachOf(std::size_t hand, const DVec3& hip, double around) const;
  void tell(double time_s, std::span<const Pose> poses);
  void answer(std::size_t hand, const Pose& pose, const Contact& felt, bool late);
  void sculpt(const Pose& pose, bool realtime) noexcept;

  BrickSource& source_;
  std::unique_ptr<TouchBackend> surface_;
  BrickTouchOptions options_;
  std::vector<Hand> hands_;
  std::vector<Contact> answers_;
  HandReaches asked_;
  BrickSculptor sculptor_;
  mutable TouchShortfalls shortfalls_;  // result of the last shortfalls()
  bool inVain_ = false;
  std::exception_ptr failure_;
  std::atomic<std::uint64_t> ticks_ = 0, without_ = 0;
};

}  // namespace palpate
