// The back ends that answer poses: the GPU through Vulkan, the CPU, or the GPU through CUDA. The programs know only
// this.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/brush.hpp"
#include "engine/core/cloud_frame.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/edit_batch.hpp"
#include "engine/core/pass_record.hpp"
#include "engine/core/shape_strokes.hpp"
#include "engine/core/simulation_control.hpp"

namespace palpate {

struct PointCloud;
class Device;
class EditLog;
class FramePipeline;
enum class SurfaceKind : std::uint32_t;

/// Deviations from a good session, in which each is zero.
struct TouchShortfalls {
  std::uint64_t editsLogFull = 0;  ///< dropped edits: a reader of the log fell behind, or the log is too small
  std::uint64_t editsTooSlow = 0;  ///< edits dropped in real time because an edit takes longer than a force can be held
  std::uint64_t offersTooSlow = 0;   ///< answers that postponed offered changes, for the same reason
  std::uint64_t editsHeldUp = 0;     ///< edits dropped in real time because the index was being compacted
  std::uint64_t editsRebuilt = 0;    ///< edits for which the index had to be rebuilt
  std::uint64_t truncatedTicks = 0;  ///< the proxy had not converged when the work budget was spent
  std::uint64_t thinnedTicks = 0;    ///< more points were in reach than a tick visits
  std::uint64_t thinnedPatches = 0;  ///< more points were in reach than the host takes to bridge late answers
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

/// Number of point states that can still be queued for the followers of the edits, and the total capacity.
struct EditRoom {
  std::uint64_t free = 0, capacity = 0;
};

/// What edits may do to the points, for code that allocates room for it.
struct EditScope {
  bool edits = true;                       ///< points may change at all
  bool paints = true;                      ///< their colours may change
  std::optional<std::uint32_t> newPoints;  ///< maximum number of new points; unlimited if empty
};

/// Cost of the edits so far, apart from their times (TouchBackend::editTimes_us), for measurements.
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

/// A cloud that can be touched and edited.
class TouchBackend : public ContactQuery {
 public:
  /// Waits for the last edit. Throws errors of earlier queries.
  virtual void finish() = 0;
  /// Updates `cloud`, which must be the one this was made from, to the present state (editedCloud() of engine/cloud).
  /// Returns the number of edited points: moved, recoloured, removed or new.
  virtual std::size_t readBack(PointCloud& cloud) const = 0;
  /// If a source moves the points: the newest complete frame that was felt. False if none has arrived since the last
  /// call. For one thread, as takeEdits().
  virtual bool takeFrame(CloudFrame&) { return false; }

  /// If a source moves the points: the time for which the points felt last are true.
  virtual std::optional<PointsTime> pointsTime() const noexcept { return std::nullopt; }
  /// Sets the springs by which hands press on a surface that yields, from the next query on. For the thread that
  /// queries.
  virtual void setSprings(std::span<const HandSpring>) {}

  /// The simulation that moves the points; null if there is none.
  virtual SimulationControl* simulation() { return nullptr; }
  /// Real time: a simulation delays no tick and drops time that it has missed; otherwise it advances as far as the
  /// poses do. For the thread that queries, between queries.
  virtual void setRealtime(bool /*realtime*/) {}

  /// Strokes that change the rest shape of a simulated body; null where that is not supported.
  virtual ShapeStrokes* shapeStrokes() { return nullptr; }
  virtual const ShapeStrokes* shapeStrokes() const { return nullptr; }

  // Edits for their followers: a journal, a session log. Only if keepsEdits().

  virtual bool keepsEdits() const { return false; }
  /// From now on edits are kept for takeEdits(). Before the first query.
  virtual void keepEdits() { noEdits(); }
  /// Appends all edits since the last call, in order. For one thread, which may differ from the thread that queries and
  /// does not delay it. If the back end's throughput queue is used too: for the thread that uses that queue.
  virtual void takeEdits(EditBatch&) { noEdits(); }
  /// Free space of the edit log, if edits are dropped when it is full; empty if it is unlimited. For any thread.
  virtual std::optional<EditRoom> editRoom() const { return std::nullopt; }
  /// Ends the stroke in progress, if any, and sets points exactly to `to` of `changes`: moved, removed, restored or
  /// new, each of them once. Complete on return; takeEdits() reports it with a mark of its own. For the thread that
  /// queries, between queries.
  virtual void change(std::span<const PointChange>) { noEdits(); }
  /// Offers changes made elsewhere, at most mostOffered(), each point once. They are carried out between later answers,
  /// and no answer waits for them: a point that is not in its change's `from` state stays as it is. They do not end a
  /// stroke. takeEdits() reports their result once, with a mark of its own (EditMark::Kind::received).
  /// `changesFollowed`: number of change() marks that the caller has taken; if there are more, the offer is dropped.
  /// False while the last offer has not been reported. For one thread, which may differ from the thread that queries.
  virtual bool offer(std::span<const PointChange> /*changes*/, std::uint64_t /*changesFollowed*/) { noEdits(); }
  /// 0: nothing can be offered, as where points are inserted and removed to keep the surface whole.
  virtual std::size_t mostOffered() const { return 0; }
  virtual EditScope editScope() const { return {}; }
  /// The log of the edits on the GPU `sight`, for drawing there; null if the edits are not on that GPU.
  virtual EditLog* editLogOn(const Device& /*sight*/) { return nullptr; }
  /// The pipeline that brings the frames of a source to the GPU `sight`, for drawing there; null if there is none on
  /// that GPU.
  virtual FramePipeline* framesOn(const Device& /*sight*/) { return nullptr; }
  /// Number of states that takeEdits() has reported or will report from before the last answer (kept or not), so that
  /// answers and edits can be ordered.
  virtual std::uint64_t editsAnswered() const { return 0; }

  /// Replaces the brush, or removes it. Only where points can be edited. For the thread that queries, between queries;
  /// ends the stroke in progress.
  virtual void setBrush(const std::optional<BrushOptions>&) { noEdits(); }
  /// Changes the surface, coefficient of friction or method, by its name; contacts restart with the next pose. For the
  /// thread that queries, between queries. Throws UsageError if unsupported.
  virtual void setContact(SurfaceKind surface, double friction, std::string_view method);

  /// Name of the answering machine.
  virtual std::string machine() const = 0;
  /// Time of the first build of the index, us.
  virtual double buildTime_us() const = 0;
  /// Time of each edit so far, until points, normals and index are complete, us, on the answering machine.
  virtual const std::vector<double>& editTimes_us() const = 0;
  /// Times of the ticks that the CPU answered because the GPU was late, us; the first ones, if the back end keeps them.
  virtual std::span<const double> bridgeTimes_us() const { return {}; }
  /// The time of the first pose whose answer led to an edit; empty while the cloud is unedited.
  virtual std::optional<double> firstEditTime_s() const = 0;
  virtual const TouchShortfalls& shortfalls() const = 0;
  virtual IndexWork indexWork() const = 0;
  /// How often the index was compacted in the background.
  virtual std::uint64_t compactions() const { return 0; }
  virtual bool isCompacting() const { return false; }
  /// Zero and empty if the back end does not measure them. For the thread that queries, between queries.
  virtual EditCosts editCosts() const { return {}; }
  virtual BackendMemory memory() const { return {}; }
  /// The passes of a tick in order, edit included, with their last times; empty if the back end has no passes.
  virtual std::vector<PassRecord> passes() const { return {}; }
  /// Edge of a cell of the index, model units.
  virtual double cell() const = 0;

 private:
  [[noreturn]] void noEdits() const;
};

}  // namespace palpate
