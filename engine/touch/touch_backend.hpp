// The back ends that answer poses: the GPU through Vulkan, the CPU, or the GPU through CUDA. The programs know only
// this.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/core/brush.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/edit_stream.hpp"
#include "engine/core/pass_record.hpp"
#include "engine/core/shape_strokes.hpp"
#include "engine/core/simulation_control.hpp"

namespace palpate {

/// Ticks that the last patch answered, because their own answer was late; and those of them for which the patch had
/// only a share of its points.
struct BridgedTicks {
  std::uint64_t ticks = 0, thinned = 0;
};

/// Counts them. One thread writes, any thread reads.
class BridgedCount {
 public:
  void note(bool thinned) noexcept {
    ticks_.fetch_add(1, std::memory_order_relaxed);
    thinned_.fetch_add(thinned, std::memory_order_relaxed);
  }
  BridgedTicks sum() const noexcept {
    return {.ticks = ticks_.load(std::memory_order_relaxed), .thinned = thinned_.load(std::memory_order_relaxed)};
  }

 private:
  std::atomic<std::uint64_t> ticks_ = 0, thinned_ = 0;
};

struct PointCloud;
class GpuPoints;
enum class SurfaceKind : std::uint32_t;

/// Deviations from a good session, in which each is zero.
struct TouchShortfalls {
  std::uint64_t editsLogFull = 0;  ///< dropped edits: a reader of the log fell behind, or the log is too small
  std::uint64_t editsTooSlow = 0;  ///< edits dropped in real time because an edit takes longer than a force can be held
  std::uint64_t offersTooSlow = 0;   ///< answers that postponed offered changes, for the same reason
  std::uint64_t editsHeldUp = 0;     ///< edits dropped in real time because the index was being compacted
  std::uint64_t pathsDropped = 0;    ///< strokes in virtual time that ended before the end of their path: too much work
  std::uint64_t editsRebuilt = 0;    ///< edits for which the index had to be rebuilt
  std::uint64_t truncatedTicks = 0;  ///< the proxy had not converged when the work budget was spent
  std::uint64_t thinnedTicks = 0;    ///< more points were in reach than a tick visits
  std::uint64_t thinnedPatches = 0;  ///< more points were in reach than the host takes to bridge late answers

  std::uint64_t droppedEdits() const { return editsLogFull + editsTooSlow + editsHeldUp; }
};

/// How the index followed the edited points. Its first build does not count.
struct IndexWork {
  std::uint64_t followed = 0;  ///< edits that it followed incrementally, at the cost of the touched points
  std::uint64_t built = 0;     ///< full rebuilds
};

/// The spring between a hand and a surface that yields: the force on the hand acts on the surface, too.
struct HandSpring {
  double stiffness_N_per_unit = 0;  ///< per model unit, as all members
  double damping_N_s_per_unit = 0;
  double most_N = 0;  ///< maximum force on the hand
};

/// What edits may do to the points, for code that allocates room for it.
struct EditScope {
  bool edits = true;                       ///< points may change at all
  bool paints = true;                      ///< their colours may change
  std::optional<std::uint32_t> newPoints;  ///< maximum number of new points; unlimited if empty
};

/// Cost of the edits so far, apart from their times (BackendReport::editTimes_us).
struct EditCosts {
  /// Time after each edit to find the points to insert and remove with the next one, us; 0 where the edit's own time
  /// includes it.
  std::span<const double> requests_us;
  std::uint64_t states = 0;            ///< point states that the edits have produced
  std::uint32_t lastTouched = 0;       ///< points that the last edit changed, moved or removed
  double longestCompactionEnd_us = 0;  ///< longest wait of the touch thread for the end of a compaction
};

/// Memory of an edited cloud on the answering machine, bytes.
struct BackendMemory {
  std::uint64_t points = 0;  ///< positions and normals, spare slots included
  std::uint64_t index = 0;   ///< over all slots
  std::uint64_t lists = 0;   ///< lists by which the index follows edits
};

/// A back end and its work so far. Its spans and its name are valid until the next query of the back end.
struct BackendReport {
  std::string_view machine;  ///< name of the answering machine
  double cell = 0;           ///< edge of a cell of the index, model units
  EditScope scope;           ///< what edits may do to its points
  double build_us = 0;       ///< time of the first build of the index
  /// Time of each edit so far, until points, normals and index are complete, us, on the answering machine.
  std::span<const double> editTimes_us{};
  /// The time of the first pose whose answer led to an edit; empty while the cloud is unedited.
  std::optional<double> firstEdit_s{};
  EditCosts costs{};  ///< zero and empty if the back end does not measure them
  /// Times of the ticks that the CPU answered because the GPU was late, us; the first ones, if the back end keeps them.
  std::span<const double> bridgeTimes_us{};
  TouchShortfalls shortfalls{};
  IndexWork index{};
  std::uint64_t compactions = 0;  ///< of the index, in the background
  bool isCompacting = false;
  BackendMemory memory{};
};

/// The frames of a source that moves the points.
class FrameStream {
 public:
  virtual ~FrameStream() = default;
  /// The newest complete frame that was felt. False if none has arrived since the last call. For one thread, which may
  /// differ from the thread that queries.
  virtual bool take(CloudFrame& frame) = 0;
  /// The time for which the points felt last are true; empty where that is the time of the pose. For the thread that
  /// queries.
  virtual std::optional<PointsTime> time() const noexcept = 0;
};

/// Throws Error unless as many states are given as a back end has probes.
void requireStates(std::size_t given, std::size_t probes);

/// A cloud that can be touched. Unless stated otherwise, its functions are for the thread that queries, between
/// queries.
class TouchBackend : public ContactQuery {
 public:
  /// Begins a run. `realtime`: a simulation delays no tick and drops time that it has missed; otherwise it advances as
  /// far as the poses do. `springs`: those by which the hands press on a surface that yields, one for each hand.
  virtual void begin(bool /*realtime*/, std::span<const HandSpring> /*springs*/) {}
  /// Waits for the last edit. Throws errors of earlier queries.
  virtual void finish() = 0;
  /// Updates `cloud`, which must be the one this was made from, to the present state (editedCloud() of engine/cloud).
  /// Returns the number of edited points: moved, recoloured, removed or new.
  virtual std::size_t readBack(PointCloud& cloud) const = 0;
  /// Changes the surface, coefficient of friction or method, by its name; contacts continue, the stroke in progress
  /// ends. Throws UsageError if unsupported.
  virtual void setContact(SurfaceKind surface, double friction, std::string_view method);
  /// Replaces the brush of the first hand, or removes it; ends the stroke in progress. Throws UsageError if
  /// unsupported.
  virtual void setBrush(const std::optional<BrushOptions>& brush);
  /// From now on the first hand changes no points before it has left the surface, or has released its button. After
  /// finish(). No effect where a stroke is not of this program.
  virtual void awaitRelease() {}

  /// State of the contact of each probe, hand by hand, the HIP first; empty where contacts cannot be restored.
  virtual std::vector<ProxyTracker::State> contacts() const { return {}; }
  /// The contacts continue from such states of a back end with the same tools, and the hand has not sculpted before.
  /// After finish(). Throws Error for another number of them.
  virtual void restoreContacts(std::span<const ProxyTracker::State>) {}

  // Null where there are none.
  virtual EditStream* edits() noexcept { return nullptr; }
  virtual FrameStream* frames() noexcept { return nullptr; }
  /// The simulation that moves the points.
  virtual SimulationControl* simulation() noexcept { return nullptr; }
  /// Strokes that change the rest shape of a simulated body.
  virtual ShapeStrokes* shapeStrokes() noexcept { return nullptr; }
  virtual GpuPoints* gpuPoints() noexcept { return nullptr; }

  /// So far. For any thread.
  virtual BridgedTicks bridged() const noexcept { return {}; }
  /// Allocates nothing.
  virtual BackendReport report() const = 0;
  /// The passes of a tick in order, edit included, with their last times; empty if the back end has no passes.
  virtual std::vector<PassRecord> passes() const { return {}; }
};

/// Wraps a back end. What is not overridden is the wrapped back end's. An override of ask() overrides points() and
/// resetHand(), too.
class TouchDecorator : public TouchBackend {
 public:
  explicit TouchDecorator(std::unique_ptr<TouchBackend> inner) : inner_(std::move(inner)) {}

  std::size_t hands() const noexcept override { return inner_->hands(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override {
    return inner_->ask(poses, budget_us);
  }
  void endTick() noexcept override { inner_->endTick(); }
  std::span<const PointContact> points(std::size_t hand) const noexcept override { return inner_->points(hand); }
  void resetHand(std::size_t hand) noexcept override { inner_->resetHand(hand); }
  void begin(bool realtime, std::span<const HandSpring> springs) override { inner_->begin(realtime, springs); }
  void finish() override { inner_->finish(); }
  std::size_t readBack(PointCloud& cloud) const override { return inner_->readBack(cloud); }
  void setContact(SurfaceKind surface, double friction, std::string_view method) override {
    inner_->setContact(surface, friction, method);
  }
  void setBrush(const std::optional<BrushOptions>& brush) override { inner_->setBrush(brush); }
  void awaitRelease() override { inner_->awaitRelease(); }
  std::vector<ProxyTracker::State> contacts() const override { return inner_->contacts(); }
  void restoreContacts(std::span<const ProxyTracker::State> states) override { inner_->restoreContacts(states); }
  EditStream* edits() noexcept override { return inner_->edits(); }
  FrameStream* frames() noexcept override { return inner_->frames(); }
  SimulationControl* simulation() noexcept override { return inner_->simulation(); }
  ShapeStrokes* shapeStrokes() noexcept override { return inner_->shapeStrokes(); }
  GpuPoints* gpuPoints() noexcept override { return inner_->gpuPoints(); }
  BridgedTicks bridged() const noexcept override { return inner_->bridged(); }
  BackendReport report() const override { return inner_->report(); }
  std::vector<PassRecord> passes() const override { return inner_->passes(); }

 protected:
  TouchBackend& inner() const noexcept { return *inner_; }
  /// FrameStream::time() of the wrapped back end.
  std::optional<PointsTime> framesTime() const noexcept {
    const FrameStream* const frames = inner_->frames();
    return frames ? frames->time() : std::nullopt;
  }

 private:
  std::unique_ptr<TouchBackend> inner_;
};

}  // namespace palpate
