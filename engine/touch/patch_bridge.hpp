#pragma once

#include <array>
#include <memory>
#include <optional>

#include "engine/contact/carried_patch.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/compute_pipeline.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/spatial/hash_grid.hpp"
#include "engine/touch/patch_contact.hpp"
#include "shaders/shared/patch.h"

namespace palpate {

/// The pass that copies the patch to the host. It runs in its own command list when a new patch is needed, so that no
/// answer waits for it; the list's fence signals that the patch is complete.
class PatchFetch {
 public:
  /// As the members of ContactOptions.
  struct Motion {
    bool pointsMove = false, normalsTurn = false;
  };
  /// `grid`: of the hash used in record(). `points`: maximum number of points of the cloud. `radius`: support radius,
  /// model units.
  PatchFetch(Device& device, const HashGrid& grid, double radius, std::uint32_t points, const Motion& motion);

  /// `velocities`: as for ContactStep.
  void record(CommandList& commands, const shared::CloudView& cloud, DeviceAddress velocities) const;
  /// Sets the position of the next fetch; not during a run. Moving points are `age_s` older than their index; `centre`
  /// is a position in the index, which has moved to `now`.
  void aimAt(const Vec3& centre, double age_s, const Vec3& now);
  /// The patch of the last run; valid until the next run starts.
  CarriedPatch patch() const;

 private:
  double reach_;
  ComputePipeline pass_;
  Buffer centre_, patch_, near_;
  Vec3 aim_{0};
};

class Device;

/// Bridges late answers of the GPU: keeps a patch of the live cloud on the host, refetched where the probe moves and
/// after every edit, and answers from it. A fetch runs on the latency queue behind the question just asked; the host
/// copies the patch once its fence has signalled, and only then requests another.
class PatchBridge {
 public:
  /// `grid`: of the hash used by the fetch. `origin`: of the cloud, in the poses' coordinates.
  PatchBridge(Device& device, const HashGrid& grid, const DVec3& origin, const SurfaceOptions& surface, double friction,
              std::uint32_t points, const PatchFetch::Motion& motion);

  /// Records the fetch for one half of the live cloud; `velocities`: as for ContactStep.
  void record(std::uint32_t parity, const shared::CloudView& cloud, DeviceAddress velocities);

  /// Requests a patch at `pose`, unless the present or pending one suffices. Call after submitting a question, so that
  /// the host's part overlaps with the GPU's work. `points`: time of the points of that half, if they move.
  void renew(const Pose& pose, std::uint32_t parity, const PointsTime& points);
  /// Whether a fetch is pending.
  bool isFetching() {
    takeIn();
    return underWay_.has_value();
  }
  /// An edit was submitted at `time_s`.
  void edited(double time_s);
  /// Takes the GPU's answer to `pose`, received at `now_s`, and the proxy state after it.
  void answered(const Contact& contact, const Pose& pose, const ProxyTracker::State& state, double now_s);

  /// The GPU answered at `now_s`, but the answer is no longer valid.
  void heard(double now_s) { contact_.heard(now_s); }
  /// The stylus was repositioned: ends the contact and discards the state.
  void reset() { contact_.goOnFrom({.valid = true}, {}, {}); }

  /// Answer for a tick whose own answer is late. Throws DeviceLost.
  Contact answer(const Pose& pose);

  /// For another probe of such a tick, after answer(): PatchContact::follow and trust.
  std::optional<Contact> follow(ProxyTracker& tracker, const Pose& pose) const {
    return contact_.follow(tracker, pose);
  }
  double trust(double time_s) const { return contact_.trust(time_s); }

  /// State from which the GPU must continue at its next question, if that is not its own last answer.
  std::optional<ProxyTracker::State> newerState() const;
  /// newerState() was passed to the GPU, or was empty.
  void handedOver() { contact_.handedOver(); }

  /// Times of answer(), us; a bounded number is kept.
  const std::vector<double>& answerTimes_us() const { return answerTimes_us_; }
  std::uint64_t thinnedPatches() const { return thinnedPatches_; }
  bool isThinned() const { return contact_.isThinned(); }

 private:
  struct Fetch {
    Queue::Ticket ticket = 0;
    double time_s = 0;        // time of the pose that it was requested for
    std::uint64_t edits = 0;  // number of edits that it includes
    PointsTime points;        // if they move
  };
  void takeIn();
  bool wanted(const DVec3& place) const;

  Device& device_;
  double radius_;
  DVec3 origin_;
  bool pointsMove_;
  PatchFetch pass_;
  std::array<std::unique_ptr<CommandList>, 2> lists_;
  PatchContact contact_;
  std::optional<Fetch> underWay_, taken_;
  std::uint64_t edits_ = 0;  // number submitted so far
  std::uint64_t thinnedPatches_ = 0;
  std::vector<double> answerTimes_us_;
};

}  // namespace palpate
