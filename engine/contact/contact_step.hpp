#pragma once

#include <optional>

#include "engine/contact/gather.hpp"
#include "engine/contact/surface_kind.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/contact.h"

namespace palpate {

/// Edge of the smallest hash cells that one gather can cover at a support radius; both in the same unit.
double smallestCell(double radius);

struct ContactOptions {
  double radius = 0;  ///< support radius, model units
  QueryMethod method = QueryMethod::fused;
  SurfaceKind surface = SurfaceKind::average;
  bool localRadius = false;   ///< take a smaller support radius where points lie close (SurfaceOptions)
  double widening = 1;        ///< of the support radius, where the surface is flat (SurfaceOptions)
  double friction = 0;        ///< coefficient, of a proxy that slides
  std::optional<bool> split;  ///< fused: whether a few workgroups share a gather; where not given, as the patch's size
                              ///< asks for. The answers are the same, bit by bit.
  bool pointsMove = false;    ///< each with a velocity; the answers know the surface's
  bool normalsTurn = false;   ///< and those of points that move, each with a turn
  std::uint32_t probes = 1;   ///< that are answered at once, each with a state of its own; more than one only fused
};

/// The contact step: gathers the neighbours of the probe by one of the query methods, evaluates the surface and moves
/// the proxy. Surfaces as SurfaceSums makes them, with Wendland's C2 weight; proxy by tangent-plane tracking
/// (Salisbury and Tarr 1997) with friction (Ruspini, Kolarov, Khatib 1997), as ProxyTracker does it.
///
/// A tick runs firstList() of the lists recorded here, then nextList() until there is none. A fused step can also be
/// submitted before its questions are there: it then waits on the GPU, for some ms at most, until the host has put
/// them.
class ContactStep {
 public:
  /// `grid`: of the hash that record() is going to see. `points`: how many the cloud may have.
  ContactStep(Device& device, const ContactOptions& options, const HashGrid& grid, std::uint32_t points);

  /// Command lists to record ahead.
  std::uint32_t lists() const;
  /// The run of these lists reads the question that was put and leaves its answer in sample(). `logHead`: address of a
  /// uint32 that is copied into the answer. `velocities`: where points move, as shaders/shared/motion.h has them.
  void record(CommandList& commands, std::uint32_t list, const shared::CloudView& cloud, DeviceAddress logHead,
              DeviceAddress velocities = 0) const;
  std::uint32_t firstList() const;
  /// Whether there are lists that wait for their question.
  bool canWait() const { return !gather_; }
  /// The list that does what `list` does, and waits for its question first.
  std::uint32_t waiting(std::uint32_t list) const { return list + static_cast<std::uint32_t>(forms_.size()); }
  bool waits(std::uint32_t list) const { return canWait() && list >= forms_.size(); }
  /// What runs after `list` has run; does the host's part between them.
  std::optional<std::uint32_t> nextList(std::uint32_t list) const;

  /// For the next run, or the one that waits for it. Its tick is another than that of the question before, and not 0.
  /// All probes are asked at the same tick.
  void put(shared::ContactQuestion question, std::uint32_t probe = 0);
  /// Instead of the questions that a list is waiting for: it ends without an answer. A tick like put()'s.
  void withdraw(std::uint32_t tick);
  /// Before a list that waits is submitted: the question that stands there now is not the one.
  void awaitAnother() { lastTick_.mapped<std::uint32_t>()[0] = question_.tick; }
  /// Host-read, after a run.
  shared::ContactSample sample(std::uint32_t probe = 0) const;
  /// Whether the answer to `tick` is there, whole, for all probes; true some us before the driver knows that the run is
  /// over.
  bool hasAnswered(std::uint32_t tick) const;
  /// Whether `list` ends in an answer.
  bool answers(std::uint32_t list) const { return !gather_ || list + 1 == gather_->submissions(); }
  /// The states on the GPU, one for each probe, for passes that follow in the same tick.
  const Buffer& state() const { return state_; }
  double radius() const { return options_.radius; }
  /// Bytes on the GPU of a fused step with cells as wide as the support radius.
  static std::uint64_t predictedBytes(std::uint64_t points);

 private:
  void recordAwait(CommandList& commands) const;
  void recordSolve(CommandList& commands, const shared::ContactStepArgs& args, const Buffer& pose,
                   std::uint32_t gather) const;

  ContactOptions options_;
  std::uint32_t cells_;               // of one gather, at most
  std::uint32_t spillSlots_;          // of each probe, two for a point
  std::unique_ptr<Gather> gather_;    // none: fused
  std::vector<std::uint32_t> forms_;  // fused: kGather... of each list
  ComputePipeline step_;
  std::uint32_t polls_;
  ComputePipeline await_;
  shared::ContactPose question_{};  // the last one that was put
  struct Seen {
    std::uint32_t tick = 0, probes = 0;
  };
  mutable Seen seen_;  // so many probes' answers to that tick are there
  Buffer pose_, lastTick_, taken_, state_, sample_, spill_, patch_;
};

}  // namespace palpate
