// A server's points by brick, as the clients near their hands get them: edited or moving ones, and forces.
#pragma once

#include <memory>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "engine/core/clock.hpp"
#include "haptics/shared_presence.hpp"
#include "haptics/sharing/client_stream.hpp"
#include "haptics/sharing/served_bricks.hpp"
#include "haptics/sharing/shared_points.hpp"

namespace palpate::sharing {

/// Not thread-safe.
class NearPoints {
 public:
  /// `points`: of a static cloud; must outlive this. `edge`: of a brick.
  NearPoints(const SharedPoints& points, double edge, bool moves) : points_(points), bricks_(edge), moves_(moves) {}

  bool moves() const { return moves_; }
  const ServedBricks& bricks() const { return bricks_; }
  const SharedPoints& edited() const { return points_; }

  /// Current frame of moving points, and the forces on hands.
  void show(std::shared_ptr<const CloudFrame> frame, std::span<const SeenHand> hands);
  bool isShown() const { return since_.has_value(); }
  HandsForces forcesOn(const Id& client) const;
  /// Other bricks are wanted than before.
  void wantOthers() { isOld_ = true; }

  /// Brings the bricks up to date. `wanted` gives the bricks that any client wants. Returns the seconds until there may
  /// be something new.
  template <class Wanted>
  double update(Wanted&& wanted) {
    if (!moves_) {
      follow();
      return kIdle_s;
    }
    const double due_s = showDue_s();
    if (due_s > 0) return due_s;
    showNow(wanted());
    return kIdle_s;
  }

 private:
  static constexpr double kIdle_s = 0.05;
  void follow();
  double showDue_s() const;
  void showNow(const std::unordered_set<BrickKey>& wanted);

  const SharedPoints& points_;
  ServedBricks bricks_;
  bool moves_;
  SharedPoints::Place place_;  // the bricks contain the edits up to here
  bool isBuilt_ = false;
  std::vector<PointState> states_;
  // Of moving points.
  std::shared_ptr<const CloudFrame> frame_;
  bool isOld_ = false;              // the frame is new, or was searched for other bricks than those wanted now
  std::optional<Stopwatch> since_;  // the last search; empty: never shown
  std::unordered_map<std::uint32_t, DVec3> forces_N_;  // by SeenHand::number
};

}  // namespace palpate::sharing
