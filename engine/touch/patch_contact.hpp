#pragma once

#include <optional>
#include <vector>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/core/contact_query.hpp"
#include "shaders/shared/patch.h"

namespace palpate {

struct CarriedPatch;

// A patch is trusted in full for the first of two times and not at all after the second.
/// Since an edit that it knows nothing of, which moves a point by a quarter of a support radius at most. An edit in
/// real time takes no longer than the first (EditPace), or others wait.
constexpr double kOutdated_s = 0.02, kMaxOutdated_s = 0.04;
/// Since the last word from whoever holds the cloud. An unedited cloud does not change: this is for a GPU that hangs.
constexpr double kSilent_s = 0.1, kMaxSilent_s = 0.2;

/// Answers poses on the CPU from the last patch of points, in double precision: the same surface and the same proxy as
/// the GPU's, going on from the GPU's last answer. For a tick whose own answer is late. Allocates nothing after it was
/// made.
///
/// Force ends softly where the patch does: past its border on the tangent plane of the last proxy within (heldContact),
/// kOutdated_s to kMaxOutdated_s after an edit that it knows nothing of, and kSilent_s to kMaxSilent_s after the last
/// word.
class PatchContact final : private SurfaceField {
 public:
  /// `origin`: of the cloud, in the poses' coordinates.
  PatchContact(const SurfaceOptions& surface, double friction, const DVec3& origin);

  /// Copies the patch, which is true of the cloud but for edits from `missingSince_s` on. Where points move it goes on
  /// with the velocity that was felt last.
  void take(const CarriedPatch& patch, std::optional<double> missingSince_s, const PointsTime& time = {});
  /// An edit that the patch knows nothing of began at `time_s`.
  void edited(double time_s);
  /// Whoever holds the cloud was there at `time_s`.
  void heard(double time_s) { heard_s_ = time_s; }
  /// The answer to `pose` from whoever holds the cloud; the next one goes on from the state that it left.
  void goOnFrom(const Contact& contact, const Pose& pose, const ProxyTracker::State& state);

  /// Not fresh.
  Contact answer(const Pose& pose) noexcept;
  /// A tick of any tracker over the same points, not softened. Nothing, and the tracker as it was, where it would need
  /// points from beyond the patch.
  std::optional<Contact> follow(ProxyTracker& tracker, const Pose& pose) const noexcept;
  /// How much of an answer counts at a time, 0 to 1.
  double trust(double time_s) const;

  /// What answer() and goOnFrom() have come to.
  ProxyTracker::State state() const { return tracker_.state(); }
  /// Whether answer() has gone on since the last goOnFrom() or handedOver().
  bool isAhead() const { return ahead_; }
  /// The state so far is handed to whoever holds the cloud.
  void handedOver() { ahead_ = false; }
  /// Whether a surface at `x`, relative to the cloud's origin, needs points from beyond the patch.
  bool needsMore(const DVec3& x) const { return !(glm::distance(x, centre_) + radius_ <= reach_); }
  /// Where the patch is, relative to the cloud's origin.
  const DVec3& centre() const { return centre_; }

 private:
  struct Point {
    DVec3 position;  // relative to the cloud's origin
    Vec3 normal;
  };
  SurfaceSample surface(const DVec3& x, const DVec3& facing) const override;
  DVec3 velocity(const DVec3&, const DVec3&) const override { return last_.velocity; }
  void gatherAround(const DVec3& x) const;

  SurfaceOptions surface_;
  double radius_;
  DVec3 origin_;
  ProxyTracker tracker_;
  std::vector<Point> points_;
  DVec3 centre_{0};
  double reach_ = 0;
  std::optional<double> missingSince_s_;
  PointsTime time_;  // of the points
  double heard_s_ = 0;
  Contact last_;  // that the state goes on from
  Pose lastPose_;
  bool ahead_ = false;
  // What surface() works with: the points around the place that it looked at last, and whether it was asked for one
  // past the border.
  mutable std::vector<Point> near_;
  mutable DVec3 nearCentre_{0};
  mutable bool gathered_ = false, crossedBorder_ = false;
};

}  // namespace palpate
