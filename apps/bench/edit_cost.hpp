// Results of `bench edit`: one record per model, number of touched points and method of following an edit; their
// tables, and the conclusions from them.
#pragma once

#include "apps/cli/context.hpp"
#include "engine/core/statistics.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// Bytes on the answering machine.
struct EditMemory {
  BackendMemory edited;
  std::uint64_t plain = 0;  ///< points and index of the same cloud where nothing is edited

  std::uint64_t ofIndex() const { return edited.index + edited.lists; }
  double overPlain() const { return static_cast<double>(edited.points + ofIndex()) / static_cast<double>(plain); }
};

/// Known only for a stroke in real time; its ticks are all those at full depth, with or without an edit.
struct EditStroke {
  double rate_Hz = 0, duration_s = 0;
  double freshShare = 0, editsPerSecond = 0;
  std::uint64_t missedTicks = 0;  ///< dropped because their time had passed
  std::uint64_t leftOut = 0;      ///< edits dropped for lack of time, or because the log was full
  std::uint64_t heldUp = 0;       ///< edits that waited for a compaction
};

struct EditCost {
  std::string subject, backend, brush, symmetry, index;
  std::size_t points = 0;
  std::size_t asked = 0;  ///< points that an edit should touch
  double brushRadius_mm = 0, spacing_mm = 0;
  Summary touched;   ///< points that edits moved, changed or removed
  Summary query_us;  ///< on the GPU, ticks with an edit; no samples where it was not measured
  /// On the answering machine: brush, index, normals, log; on a GPU without times, until the host saw its completion.
  Summary edit_us;
  Summary indexed_us;   ///< in virtual time: query and edit of each tick together, on the GPU
  Summary requests_us;  ///< on the GPU, after the edit: where the next edit should insert and remove points
  Summary step_us;      ///< from pose to force; in virtual time including the whole edit
  std::uint64_t edits = 0;
  std::uint64_t builds = 0;            ///< full builds of the index for these edits
  std::uint64_t compactions = 0;       ///< background compactions of the index that were completed within these ticks
  Summary compactingStep_us;           ///< steps during a compaction; in virtual time one step includes all of it
  double longestCompactionEnd_us = 0;  ///< longest wait of touch for the end of a compaction, over the session
  std::uint64_t landings = 0;          ///< how often the brush was lowered onto the surface
  EditMemory memory;
  std::optional<EditStroke> stroke;
};
Json toJson(const std::vector<EditCost>& costs);

/// The size above which an edit with a full build is cheaper than an update of the index.
struct EditCrossover {
  std::string subject, backend;
  std::size_t points = 0;
  double share = 0;    ///< touched points over all points
  bool found = false;  ///< false: `share` is the largest one measured, and the update was still cheaper there
};
/// One for each model and back end measured with both methods, from the edits' times. Only updates without a build
/// count.
std::vector<EditCrossover> crossovers(const std::vector<EditCost>& costs);

/// The edited step of the largest model relative to that of the smallest, for the same number of points.
struct EditGrowth {
  std::string backend, index;
  std::size_t asked = 0, from = 0, to = 0;  ///< points asked; points of the two models
  double factor = 0;                        ///< ratio of the median steps
};
std::vector<EditGrowth> growths(const std::vector<EditCost>& costs);

}  // namespace palpate
