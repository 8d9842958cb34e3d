#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "engine/touch/patch_contact.hpp"

namespace palpate {

/// Bridges answers of the CPU that would be late, as PatchBridge does those of the GPU: keeps a patch of the points
/// around a hand, and answers from it. Allocates nothing after construction.
class CpuBridge {
 public:
  CpuBridge(const SurfaceOptions& surface, double friction, const DVec3& origin, double cell);

  /// The points as they are now.
  struct Points {
    const SortedGrid& grid;
    std::span<const Vec3> normals;
    std::uint64_t version = 0;          ///< changes with them
    const CloudFrame* frame = nullptr;  ///< if they move
  };
  /// Takes a patch for `pose`, unless the present one suffices. With more points in reach than an answer affords, it
  /// takes an even share of them.
  void renew(const Points& points, const Pose& pose);
  /// An edit begins at `time_s`: until the next patch these points are outdated.
  void edited(double time_s) { contact_.edited(time_s); }
  /// Takes an answer in time.
  void answered(const Contact& contact, const Pose& pose, const ProxyTracker::State& state) {
    contact_.heard(pose.time_s);
    contact_.goOnFrom(contact, pose, state);
  }
  /// State from which an answer in time must continue, if that is not the state of the last one.
  std::optional<ProxyTracker::State> newerState() const {
    return contact_.isAhead() ? std::optional(contact_.state()) : std::nullopt;
  }
  /// As in PatchBridge.
  void reset() { contact_.goOnFrom({.valid = true}, {}, {}); }
  Contact answer(const Pose& pose) { return contact_.answer(pose); }
  std::optional<Contact> follow(ProxyTracker& tracker, const Pose& pose) const {
    return contact_.follow(tracker, pose);
  }
  double trust(double time_s) const { return contact_.trust(time_s); }
  /// Patches that took a share of their points.
  std::uint64_t thinnedPatches() const { return thinnedPatches_; }
  bool isThinned() const { return contact_.isThinned(); }

 private:
  DVec3 origin_;
  double radius_, reach_;
  PatchContact contact_;
  std::vector<Vec4> patch_;
  std::optional<std::uint64_t> taken_;  // version of the patch
  std::uint64_t thinnedPatches_ = 0;
};

}  // namespace palpate
