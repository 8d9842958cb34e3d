#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/contact/gather.hpp"
#include "engine/contact/surface_kind.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

/// Edge of the smallest hash cells with which one gather can cover a support radius; both in the same unit.
double smallestCell(double radius);

struct ContactOptions {
  double radius = 0;  ///< support radius, model units
  QueryMethod method = QueryMethod::fused;
  SurfaceKind surface = SurfaceKind::average;
  bool localRadius = false;   ///< use a smaller support radius where points are dense (SurfaceOptions)
  double widening = 1;        ///< of the support radius, where the surface is flat (SurfaceOptions)
  double friction = 0;        ///< coefficient, of a sliding proxy
  std::optional<bool> split;  ///< fused: whether a few workgroups share a gather; by default, decided by the patch's
                              ///< size. The answers are identical, bit by bit.
  bool pointsMove = false;    ///< each with a velocity; answers include the surface's
  bool normalsTurn = false;   ///< normals of moving points rotate, too
  std::uint32_t probes = 1;   ///< answered at once, each with its own state; more than one only with fused
};

/// The contact step: gathers the neighbours of the probe by one of the query methods, evaluates the surface and moves
/// the proxy. Surfaces as in SurfaceSums, with Wendland's C2 weight; proxy by tangent-plane tracking (Salisbury and
/// Tarr 1997) with friction (Ruspini, Kolarov, Khatib 1997), as in ProxyTracker.
///
/// A tick runs firstList() of the lists recorded here, then nextList() until it returns nothing. A fused step can also
/// be submitted before its questions are known: it then waits on the GPU, for some ms at most, until the host has put
/// them.
class ContactStep {
 public:
  /// `grid`: of the hash used in record(). `points`: maximum number of points of the cloud.
  ContactStep(Device& device, const ContactOptions& options, const HashGrid& grid, std::uint32_t points);

  /// Number of command lists to record ahead.
  std::uint32_t lists() const;
  /// These lists read the question that was put and write the answer for sample(). `logHead`: address of a uint32 that
  /// is copied into the answer. `velocities`: if points move, as in shaders/shared/motion.h.
  void record(CommandList& commands, std::uint32_t list, const shared::CloudView& cloud, DeviceAddress logHead,
              DeviceAddress velocities = 0) const;
  std::uint32_t firstList() const;
  /// Whether there are lists that wait for their question.
  bool canWait() const { return !gather_; }
  /// The variant of `list` that waits for its question first.
  std::uint32_t waiting(std::uint32_t list) const { return list + static_cast<std::uint32_t>(forms_.size()); }
  bool waits(std::uint32_t list) const { return canWait() && list >= forms_.size(); }
  /// The list to run after `list`; does the host's part between them.
  std::optional<std::uint32_t> nextList(std::uint32_t list) const;

  /// Sets the question for the next run, or for the list that waits for it. Its tick must differ from that of the
  /// previous question, and not be 0. All probes of a run have the same tick.
  void put(shared::ContactQuestion question, std::uint32_t probe = 0);
  /// Withdraws the questions that a list is waiting for: it ends without an answer. `tick` as for put().
  void withdraw(std::uint32_t tick);
  /// Called before a waiting list is submitted: makes it ignore the current question. `rehearses`: a step of one probe
  /// repeats the last one before it waits, so that its data are in the caches.
  void awaitAnother(bool rehearses);
  /// Of the last run of `list`, whose section "contact" took `section_us`: the time without the wait for the question.
  /// 0 if the GPU has no clock to tell.
  double answeringTime_us(std::uint32_t list, double section_us) const;
  /// The answer, read by the host after a run.
  shared::ContactSample sample(std::uint32_t probe = 0) const;
  /// Whether the complete answer to `tick` has arrived for all probes; true some us before the driver reports the end
  /// of the run.
  bool hasAnswered(std::uint32_t tick) const;
  /// Whether `list` produces an answer.
  bool answers(std::uint32_t list) const { return !gather_ || list + 1 == gather_->submissions(); }
  /// The states on the GPU, one for each probe, for later passes of the same tick.
  const Buffer& state() const { return state_; }
  double radius() const { return options_.radius; }
  /// GPU memory, bytes, of a fused step with cells as wide as the support radius.
  static std::uint64_t predictedBytes(std::uint64_t points);

 private:
  // Whether the step itself waits. Several workgroups could not agree on whether the question has arrived.
  bool waitsAlone(std::uint32_t list) const;
  void recordAwait(CommandList& commands) const;
  // Sets words of pose_ from the word `first` on.
  void write(std::size_t first, std::span<const std::uint32_t> words);
  void recordSolve(CommandList& commands, const ComputePipeline& step, const shared::ContactStepArgs& args,
                   const Buffer& pose, std::uint32_t gather) const;

  ContactOptions options_;
  std::uint32_t cells_;               // maximum, of one gather
  std::uint32_t spillSlots_;          // of each probe, two per point
  std::unique_ptr<Gather> gather_;    // null: fused
  std::vector<std::uint32_t> forms_;  // fused: kGather... of each list
  ComputePipeline step_;
  std::optional<ComputePipeline> waiting_;  // the step that waits itself
  ComputePipeline await_;
  shared::ContactPose question_{};  // the last question put
  std::vector<std::uint32_t> put_;  // what pose_ holds
  struct Seen {
    std::uint32_t tick = 0, probes = 0;
  };
  mutable Seen seen_;                                     // number of probes whose answer to that tick has arrived
  Buffer pose_, taken_, state_, sample_, spill_, patch_;  // pose_ and taken_ with a head, sample_ with the step's ticks
};

}  // namespace palpate
