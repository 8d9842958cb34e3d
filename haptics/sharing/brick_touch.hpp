// Hands on a cloud of which only the bricks around them are loaded: they feel and sculpt only where points are known.
#pragma once

#include <atomic>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/edit_stream.hpp"
#include "haptics/session/far_touch.hpp"
#include "haptics/sharing/brick_sculptor.hpp"
#include "haptics/sharing/brick_source.hpp"

namespace palpate {

struct BrickTouchOptions {
  double radius = 0;                       ///< support radius of the surface, model units
  double widening = 1;                     ///< factor on the radius for noisy points; edits use the unwidened radius
  double tool = 0;                         ///< distance from a hand to the farthest point of its tool
  DVec3 origin{0};                         ///< of the cloud
  double timeout_s = 10;                   ///< timeout of virtual time, which waits for unknown points
  std::optional<BrushOptions> brush = {};  ///< of the first hand
  std::string fixed = {};                  ///< error text if the points cannot be sculpted; empty: they can
};

/// Wraps the back end that feels the points of a BrickSource, and sculpts them: it sends the source the positions of
/// the hands, and passes an answer on only if all points that it may depend on are known. Elsewhere the hand feels
/// nothing, its tick counts as one without data, and the hand is reset when points are known again. Against the clock
/// no tick waits; in virtual time each tick waits for its points, so that it is answered as if the whole cloud were
/// loaded.
/// Its edits are those of the hands here, undone ones included; points of others are in them where a hand here has
/// edited the same ones.
class BrickTouch final : public FarTouch, public EditStream {
 public:
  /// `surface` feels the points of `source`, which must outlive it.
  BrickTouch(BrickSource& source, std::unique_ptr<TouchBackend> surface, const BrickTouchOptions& options);

  UnknownTicks counts() const noexcept override { return {.ticks = ticks_.load(), .without = without_.load()}; }
  bool awaitAt(double time_s, std::span<const DVec3> hips, double timeout_s) override;

  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override;
  std::span<const PointContact> points(std::size_t hand) const noexcept override { return hands_[hand].points; }
  void resetHand(std::size_t hand) noexcept override;
  /// Throws Error if virtual time ran into its timeout.
  void finish() override;
  /// Reads back only the loaded points, with their numbers as a field unless they move; returns the number of all
  /// points that a hand here has changed.
  std::size_t readBack(PointCloud& cloud) const override;
  /// Throws UsageError if the points cannot be sculpted.
  void setBrush(const std::optional<BrushOptions>& brush) override;
  void awaitRelease() override { sculptor_.awaitRelease(); }
  EditStream* edits() noexcept override { return options_.fixed.empty() && !source_.moves() ? this : nullptr; }
  BackendReport report() const override;

  void keep() override { source_.keepEdits(); }
  void take(EditBatch& batch) override { source_.takeEdits(batch); }
  EditProgress progress() const noexcept override { return {.states = sculptor_.states(), .dropped = 0}; }
  /// Points that others have changed stay as they are, which take() reports, now or when it is known here.
  void change(std::span<const PointChange> changes) override;
  /// Edits of others are received with the bricks.
  bool offer(std::span<const PointChange>, std::uint64_t) override { return false; }
  std::size_t mostOffered() const override { return 0; }

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
  BrickTouchOptions options_;
  std::vector<Hand> hands_;
  std::vector<Contact> answers_;
  HandReaches asked_;
  BrickSculptor sculptor_;
  bool inVain_ = false;
  std::exception_ptr failure_;
  std::atomic<std::uint64_t> ticks_ = 0, without_ = 0;
};

}  // namespace palpate
