// What answers poses: the GPU through Vulkan, the CPU, or the GPU through CUDA. The programs know only this.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/brush.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/edit_batch.hpp"

namespace palpate {

struct PointCloud;

/// What did not go as it should; each is zero in a good session.
struct TouchShortfalls {
  std::uint64_t editsLogFull =
      0;  ///< edits left out: a reader of the log had fallen behind, or it is too small for them
  std::uint64_t editsTooSlow = 0;    ///< left out in real time because an edit takes longer than a force can be held
  std::uint64_t editsHeldUp = 0;     ///< left out in real time because the index was being compacted
  std::uint64_t editsBuiltAnew = 0;  ///< the index could not follow, and was built anew for them
  std::uint64_t truncatedTicks = 0;  ///< the proxy had not arrived when the work budget was spent
  std::uint64_t thinnedTicks = 0;    ///< more points were near than a tick looks at
  std::uint64_t thinnedPatches = 0;  ///< more were near than the host takes to bridge late answers
};

/// How the index came after the points that were edited. Its first build does not count.
struct IndexWork {
  std::uint64_t followed = 0;  ///< edits that it followed, at the cost of what they touched
  std::uint64_t built = 0;     ///< times that all of it was built anew
};

/// A cloud that can be touched and edited.
class TouchBackend : public ContactQuery {
 public:
  /// Waits for the last edit. Throws what a query could not.
  virtual void finish() = 0;
  /// Makes `cloud`, which must be the one this was made from, the present one (editedCloud() of engine/cloud); says how
  /// many points were edited: stand elsewhere than in the file, have another colour, are gone, or are new.
  virtual std::size_t readBack(PointCloud& cloud) const = 0;

  // What is done to the points, for whoever follows it: a journal, a session log. Only where keepsEdits() says so.

  virtual bool keepsEdits() const { return false; }
  /// From now on edits wait for takeEdits(). Before the first query.
  virtual void keepEdits() { noEdits(); }
  /// Appends all that was done since the last call, in order. For one thread, which may be another than the one that
  /// queries, and does not hold that up; where the back end's sight queue is used too, for the thread that uses it.
  virtual void takeEdits(EditBatch&) { noEdits(); }
  /// Ends the stroke that is under way, if any, and sets points exactly as `changes` have them in `to`: moved, taken
  /// away, put back or new, each of them once. Done when it returns; takeEdits() tells of it with a mark of its own.
  /// For the thread that queries, between queries.
  virtual void change(std::span<const PointChange>) { noEdits(); }
  /// How many states takeEdits() has told or will tell of that came before the last answer (kept or not), so that
  /// answers and edits can be put in order.
  virtual std::uint64_t editsAnswered() const { return 0; }

  /// Another brush from now on, or none. Only where points can be edited. For the thread that queries, between queries;
  /// ends the stroke that is under way.
  virtual void setBrush(const std::optional<BrushOptions>&) { noEdits(); }

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
  /// Edge of a cell of the index, model units.
  virtual double cell() const = 0;

 private:
  [[noreturn]] void noEdits() const;
};

}  // namespace palpate
