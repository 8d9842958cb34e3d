#pragma once

#include <optional>
#include <vector>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/core/contact_query.hpp"
#include "shaders/shared/patch.h"

namespace palpate {

struct CarriedPatch;

// A patch is fully trusted up to the first of two times, and not at all after the second.
/// Since an edit that the patch does not include, which moves a point by a quarter of a support radius at most. An edit
/// in real time takes at most the first time (EditPace), or further edits wait.
constexpr double kOutdated_s = 0.02, kMaxOutdated_s = 0.04;
/// Since the last answer from the holder of the cloud. An unedited cloud does not change: this is for a GPU that hangs.
constexpr double kSilent_s = 0.1, kMaxSilent_s = 0.2;

/// Answers poses on the CPU from the last patch of points, in double precision: the same surface and the same proxy as
/// the GPU's, continuing from the GPU's last answer. For a tick whose own answer is late. Allocates nothing after
/// construction.
///
/// The force fades out where the patch ends: past its border on the tangent plane of the last proxy inside it
/// (heldContact), kOutdated_s to kMaxOutdated_s after an edit that it does not include, and kSilent_s to kMaxSilent_s
/// after the last answer.
class PatchContact final : private SurfaceField {
 public:
  /// `origin`: of the cloud, in the poses' coordinates.
  PatchContact(const SurfaceOptions& surface, double friction, const DVec3& origin);

  /// Copies the patch, which matches the cloud except for edits from `missingSince_s` on. If points move, the patch
  /// moves on with the last felt velocity.
  void take(const CarriedPatch& patch, std::optional<double> missingSince_s, const PointsTime& time = {});
  /// An edit that the patch does not include began at `time_s`.
  void edited(double time_s);
  /// The holder of the cloud answered at `time_s`.
  void heard(double time_s) { heard_s_ = time_s; }
  /// Takes the answer to `pose` from the holder of the cloud; the next one continues from its proxy state.
  void goOnFrom(const Contact& contact, const Pose& pose, const ProxyTracker::State& state);

  /// Not fresh.
  Contact answer(const Pose& pose) noexcept;
  /// One tick of any tracker over the same points, not softened. Returns nullopt, and leaves the tracker unchanged, if
  /// it would need points beyond the patch.
  std::optional<Contact> follow(ProxyTracker& tracker, const Pose& pose) const noexcept;
  /// Weight of an answer at a time, 0 to 1.
  double trust(double time_s) const;

  /// Proxy state after the last answer() or goOnFrom().
  ProxyTracker::State state() const { return tracker_.state(); }
  /// The patch has only a share of the points in its reach.
  bool isThinned() const { return thinned_; }
  /// Whether answer() has advanced the state since the last goOnFrom() or handedOver().
  bool isAhead() const { return ahead_; }
  /// The state was passed to the holder of the cloud.
  void handedOver() { ahead_ = false; }
  /// Whether a surface at `x`, relative to the cloud's origin, needs points from beyond the patch.
  bool needsMore(const DVec3& x) const { return !(glm::distance(x, centre_) + radius_ <= reach_); }
  /// Centre of the patch, relative to the cloud's origin.
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
  bool thinned_ = false;
  std::optional<double> missingSince_s_;
  PointsTime time_;  // of the points
  double heard_s_ = 0;
  Contact last_;  // contact that the state continues from
  Pose lastPose_;
  bool ahead_ = false;
  // Working data of surface(): the points around the last queried position, and whether a position past the border was
  // queried.
  mutable std::vector<Point> near_;
  mutable DVec3 nearCentre_{0};
  mutable bool gathered_ = false, crossedBorder_ = false;
};

}  // namespace palpate
