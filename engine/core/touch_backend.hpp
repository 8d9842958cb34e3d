// What answers poses: the GPU through Vulkan, the CPU, or the GPU through CUDA. The programs know only this.
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

/// What did not go as it should; each is zero in a good session.
struct TouchShortfalls {
  std::uint64_t editsLogFull =
      0;  ///< edits left out: a reader of the log had fallen behind, or it is too small for them
  std::uint64_t editsTooSlow = 0;    ///< left out in real time because an edit takes longer than a force can be held
  std::uint64_t offersTooSlow = 0;   ///< answers that put off what was offered, for the same reason
  std::uint64_t editsHeldUp = 0;     ///< left out in real time because the index was being compacted
  std::uint64_t editsRebuilt = 0;    ///< the index could not follow, and was built anew for them
  std::uint64_t truncatedTicks = 0;  ///< the proxy had not arrived when the work budget was spent
  std::uint64_t thinnedTicks = 0;    ///< more points were near than a tick visits
  std::uint64_t thinnedPatches = 0;  ///< more were near than the host takes to bridge late answers
};

/// How the index came after the points that were edited. Its first build does not count.
struct IndexWork {
  std::uint64_t followed = 0;  ///< edits that it followed, at the cost of what they touched
  std::uint64_t built = 0;     ///< times that all of it was built anew
};

/// What stands between a hand and a surface that gives way: what it feels is what it does to it.
struct HandSpring {
  double stiffness_N_per_unit = 0;  ///< per model unit, as all of this
  double damping_N_s_per_unit = 0;
  double most_N = 0;  ///< that the hand bears
};

/// How many states of points can still wait for those who follow the edits, and how many could in all.
struct EditRoom {
  std::uint64_t free = 0, capacity = 0;
};

/// What edits may do to the points, for whoever makes room for it.
struct EditScope {
  bool edits = true;                       ///< points may change at all
  bool paints = true;                      ///< and so may their colours
  std::optional<std::uint32_t> newPoints;  ///< at most; any number where it is not given
};

/// What the edits so far have come to, beside their times (TouchBackend::editTimes_us), for whoever measures them.
struct EditCosts {
  /// What it took behind each edit to find where points should come and go with the next one, us; 0 where the edit's
  /// own time includes it.
  std::span<const double> requests_us;
  std::uint64_t states = 0;            ///< of points, that the edits have made
  std::uint32_t lastTouched = 0;       ///< points that the last one changed, moved or took away
  double longestCompactionEnd_us = 0;  ///< that touch had to wait for the end of a compaction
};

/// What a cloud that is edited takes on the machine that answers, bytes.
struct BackendMemory {
  std::uint64_t points = 0;  ///< positions and normals, spare slots included
  std::uint64_t index = 0;   ///< over all slots
  std::uint64_t lists = 0;   ///< by which the index follows edits
};

/// A cloud that can be touched and edited.
class TouchBackend : public ContactQuery {
 public:
  /// Waits for the last edit. Throws what a query could not.
  virtual void finish() = 0;
  /// Makes `cloud`, which must be the one this was made from, the present one (editedCloud() of engine/cloud); says how
  /// many points were edited: stand elsewhere than in the file, have another colour, are gone, or are new.
  virtual std::size_t readBack(PointCloud& cloud) const = 0;
  /// Where a source moves the points: the newest whole frame that was felt. False where none has come since the last
  /// call. For one thread, as takeEdits().
  virtual bool takeFrame(CloudFrame&) { return false; }

  /// Where a source moves the points: when those that were felt last are true.
  virtual std::optional<PointsTime> pointsTime() const noexcept { return std::nullopt; }
  /// How hard each hand presses on a surface that gives way, from the next question on. For the thread that asks.
  virtual void setSprings(std::span<const HandSpring>) {}

  /// Of points that move by themselves; null where they do not.
  virtual SimulationControl* simulation() { return nullptr; }
  /// Against the clock, where what moves by itself keeps no tick waiting and leaves out time that it has missed;
  /// otherwise it goes as far as the poses do. For the thread that queries, between queries.
  virtual void setRealtime(bool /*realtime*/) {}

  /// Strokes that change the shape in which what moves by itself rests; null where there can be none.
  virtual ShapeStrokes* shapeStrokes() { return nullptr; }
  virtual const ShapeStrokes* shapeStrokes() const { return nullptr; }

  // What is done to the points, for whoever follows it: a journal, a session log. Only where keepsEdits() says so.

  virtual bool keepsEdits() const { return false; }
  /// From now on edits wait for takeEdits(). Before the first query.
  virtual void keepEdits() { noEdits(); }
  /// Appends all that was done since the last call, in order. For one thread, which may be another than the one that
  /// queries, and does not hold that up; where the back end's throughput queue is used too, for the thread that uses
  /// it.
  virtual void takeEdits(EditBatch&) { noEdits(); }
  /// Where edits are left out once too many wait; nothing where any number may. For any thread.
  virtual std::optional<EditRoom> editRoom() const { return std::nullopt; }
  /// Ends the stroke that is under way, if any, and sets points exactly as `changes` have them in `to`: moved, taken
  /// away, put back or new, each of them once. Done when it returns; takeEdits() reports it with a mark of its own.
  /// For the thread that queries, between queries.
  virtual void change(std::span<const PointChange>) { noEdits(); }
  /// Changes that somebody else has made, at most mostOffered() of them, each point once. Carried out between later
  /// answers, and no answer waits for them: a point that does not stand where its change says stays as it is. They end
  /// no stroke; takeEdits() reports what has become of them with a mark of its own (EditMark::Kind::received), once.
  /// `changesFollowed`: how many marks of change() whoever offers has taken; behind another one of those nothing of it
  /// is done. False while the last ones have not been reported. For one thread, which may be another than the one that
  /// queries.
  virtual bool offer(std::span<const PointChange> /*changes*/, std::uint64_t /*changesFollowed*/) { noEdits(); }
  /// 0: nothing can be offered, as where points come and go to keep the surface whole.
  virtual std::size_t mostOffered() const { return 0; }
  virtual EditScope editScope() const { return {}; }
  /// The log of the edits on the GPU `sight`, for who draws there; null where they stand on none or on another one.
  virtual EditLog* editLogOn(const Device& /*sight*/) { return nullptr; }
  /// What brings the frames of a source to the GPU `sight`, for who draws there; null where there is none, or
  /// elsewhere.
  virtual FramePipeline* framesOn(const Device& /*sight*/) { return nullptr; }
  /// How many states takeEdits() has reported or will report that came before the last answer (kept or not), so that
  /// answers and edits can be put in order.
  virtual std::uint64_t editsAnswered() const { return 0; }

  /// Another brush from now on, or none. Only where points can be edited. For the thread that queries, between queries;
  /// ends the stroke that is under way.
  virtual void setBrush(const std::optional<BrushOptions>&) { noEdits(); }
  /// Another surface, coefficient of friction or method, by its name, from now on; the next pose begins anew. For the
  /// thread that queries, between queries. Throws UsageError where it cannot.
  virtual void setContact(SurfaceKind surface, double friction, std::string_view method);

  /// The machine that answers.
  virtual std::string machine() const = 0;
  /// Time of the first build of the index, us.
  virtual double buildTime_us() const = 0;
  /// Time of each edit so far, until points, normals and index are as it leaves them, us, on the machine that answers.
  virtual const std::vector<double>& editTimes_us() const = 0;
  /// Times on the CPU of the ticks that were answered there because the GPU was late, us; the first ones, where a
  /// back end keeps them.
  virtual std::span<const double> bridgeTimes_us() const { return {}; }
  /// The time of the first pose whose answer led to an edit; nothing while the cloud is as it was loaded.
  virtual std::optional<double> firstEditTime_s() const = 0;
  virtual const TouchShortfalls& shortfalls() const = 0;
  virtual IndexWork indexWork() const = 0;
  /// How often the index that follows edits was brought together again in the background.
  virtual std::uint64_t compactions() const { return 0; }
  virtual bool isCompacting() const { return false; }
  /// Zero and empty where a back end cannot tell. For the thread that queries, between queries.
  virtual EditCosts editCosts() const { return {}; }
  virtual BackendMemory memory() const { return {}; }
  /// The passes of a tick in order, edit included, with their last times, where the back end has any.
  virtual std::vector<PassRecord> passes() const { return {}; }
  /// Edge of a cell of the index, model units.
  virtual double cell() const = 0;

 private:
  [[noreturn]] void noEdits() const;
};

}  // namespace palpate
