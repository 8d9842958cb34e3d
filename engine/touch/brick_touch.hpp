// Hands on a cloud of which only the bricks around them are here: they feel what is known, and nothing where it is not.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "engine/core/touch_backend.hpp"
#include "engine/motion/brick_source.hpp"

namespace palpate {

struct BrickTouchOptions {
  double radius = 0;       ///< of the surface's support, model units
  double tool = 0;         ///< from a hand to the farthest point of its tool
  DVec3 origin{0};         ///< of the cloud
  double patience_s = 10;  ///< of virtual time, which waits for what is not known
};

/// Stands before the back end that feels the points of a BrickSource: it tells the source where the hands are, and lets
/// an answer pass only where all that it can be made of is known. Elsewhere the hand feels nothing, its tick counts as one
/// without data, and it begins anew where points are known again. Against the clock nobody waits; in virtual time each
/// tick waits for its points, so that it is answered as if all of the cloud were here.
class BrickTouch final : public TouchBackend {
 public:
  /// `surface` feels the points of `source`, which outlives it.
  BrickTouch(BrickSource& source, std::unique_ptr<TouchBackend> surface, const BrickTouchOptions& options);

  /// For any thread.
  UnknownTicks counts() const noexcept { return {.ticks = ticks_.load(), .without = without_.load()}; }
  /// Before the first tick: waits for what lies around such hands, so long at most. Whether it is known then.
  bool awaitAt(double time_s, std::span<const DVec3> hips, double patience_s);

  std::size_t hands() const noexcept override { return surface_->hands(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  void prepare() noexcept override { surface_->prepare(); }
  void setRealtime(bool realtime) override { surface_->setRealtime(realtime); }
  std::span<const PointContact> points(std::size_t hand) const noexcept override { return hands_[hand].points; }
  void resetHand(std::size_t hand) noexcept override;
  /// Throws Error where virtual time has waited in vain.
  void finish() override;
  std::size_t readBack(PointCloud& cloud) const override { return surface_->readBack(cloud); }
  bool takeFrame(CloudFrame& frame) override { return surface_->takeFrame(frame); }
  FramePipeline* framesOn(const Device& sight) override { return surface_->framesOn(sight); }
  std::optional<PointsTime> pointsTime() const noexcept override { return surface_->pointsTime(); }

  bool keepsEdits() const override { return true; }
  void keepEdits() override {}
  void takeEdits(EditBatch&) override {}
  EditScope editScope() const override { return surface_->editScope(); }
  /// Throws UsageError for any but none.
  void setBrush(const std::optional<BrushOptions>& brush) override;
  void setContact(SurfaceKind surface, double friction, std::string_view method) override {
    surface_->setContact(surface, friction, method);
  }

  std::string machine() const override { return surface_->machine(); }
  double buildTime_us() const override { return surface_->buildTime_us(); }
  const std::vector<double>& editTimes_us() const override { return surface_->editTimes_us(); }
  std::span<const double> bridgeTimes_us() const override { return surface_->bridgeTimes_us(); }
  std::optional<double> firstEditTime_s() const override { return std::nullopt; }
  const TouchShortfalls& shortfalls() const override { return surface_->shortfalls(); }
  IndexWork indexWork() const override { return surface_->indexWork(); }
  BackendMemory memory() const override { return surface_->memory(); }
  std::vector<PassRecord> passes() const override { return surface_->passes(); }
  double cell() const override { return surface_->cell(); }

 private:
  struct Hand {
    std::optional<DVec3> hip, proxy;   // at the last tick, where its points were known
    std::vector<PointContact> points;  // as it gets them
  };
  HandReach reachOf(std::size_t hand, const DVec3& hip, double around) const;
  void tell(double time_s, std::span<const Pose> poses);
  void answer(std::size_t hand, const Pose& pose, const Contact& felt, bool late);

  BrickSource& source_;
  std::unique_ptr<TouchBackend> surface_;
  BrickTouchOptions options_;
  std::vector<Hand> hands_;
  std::vector<Contact> answers_;
  HandReaches asked_;
  bool inVain_ = false;
  std::atomic<std::uint64_t> ticks_ = 0, without_ = 0;
};

}  // namespace palpate
