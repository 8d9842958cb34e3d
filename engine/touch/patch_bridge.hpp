#pragma once

#include <array>
#include <memory>
#include <optional>

#include "engine/contact/patch_fetch.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/touch/patch_contact.hpp"

namespace palpate {

class Device;

/// Bridges late answers of the GPU: keeps a patch of the live cloud on the host, fetched anew where the probe goes and
/// after every edit, and answers from it. A fetch runs on the latency queue behind the question that was just asked;
/// the host copies it once its fence says that it is whole, and only then asks for another.
class PatchBridge {
 public:
  /// `grid`: of the hash that is fetched through. `origin`: of the cloud, in the poses' coordinates.
  PatchBridge(Device& device, const HashGrid& grid, const DVec3& origin, const SurfaceOptions& surface, double friction,
              std::uint32_t points, const PatchFetch::Motion& motion);

  /// Records the fetch for one half of the live cloud; `velocities`: as for ContactStep.
  void record(std::uint32_t parity, const shared::CloudView& cloud, DeviceAddress velocities);

  /// Asks for a patch at `pose`, unless the one that is there, or on its way, will do. After a question was submitted,
  /// so that the host's part is done while the GPU works on that. `points`: the time of those of that half, where they
  /// move.
  void renew(const Pose& pose, std::uint32_t parity, const PointsTime& points);
  /// Whether a patch is on its way.
  bool isFetching() {
    takeIn();
    return underWay_.has_value();
  }
  /// An edit was submitted at `time_s`.
  void edited(double time_s);
  /// The GPU's answer to `pose`, taken in at `now_s`, and the state that it left.
  void answered(const Contact& contact, const Pose& pose, const ProxyTracker::State& state, double now_s);

  /// The GPU was there at `now_s`, with an answer that counts no more.
  void heard(double now_s) { contact_.heard(now_s); }
  /// The stylus is put down elsewhere: nothing is touched, and no state so far goes on.
  void reset() { contact_.goOnFrom({.valid = true}, {}, {}); }

  /// For a tick whose own answer is late. Throws DeviceLost.
  Contact answer(const Pose& pose);

  /// For another probe of such a tick, after answer(): PatchContact::follow and trust.
  std::optional<Contact> follow(ProxyTracker& tracker, const Pose& pose) const {
    return contact_.follow(tracker, pose);
  }
  double trust(double time_s) const { return contact_.trust(time_s); }

  /// What the GPU has to go on from at its next question, when that is not its own last answer.
  std::optional<ProxyTracker::State> newerState() const;
  /// The state was handed over, or there was none.
  void handedOver() { contact_.handedOver(); }

  /// Times of answer(), us; as many as are kept.
  const std::vector<double>& answerTimes_us() const { return answerTimes_us_; }
  std::uint64_t thinnedPatches() const { return thinnedPatches_; }

 private:
  struct Fetch {
    Queue::Ticket ticket = 0;
    double time_s = 0;        // of the pose that it was asked for
    std::uint64_t edits = 0;  // that it sees
    PointsTime points;        // where they move
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
  std::uint64_t edits_ = 0;  // submitted so far
  std::uint64_t thinnedPatches_ = 0;
  std::vector<double> answerTimes_us_;
};

}  // namespace palpate
