// What `bench edit` finds: one record for each model, number of touched points and way to follow an edit; tables of
// them, and what can be read from them.
#pragma once

#include "apps/cli/context.hpp"
#include "engine/core/statistics.hpp"
#include "engine/core/touch_backend.hpp"

namespace palpate {

/// Bytes on the GPU.
struct EditMemory {
  BackendMemory edited;
  std::uint64_t plain = 0;  ///< points and index of the same cloud where nothing is edited

  std::uint64_t ofIndex() const { return edited.index + edited.lists; }
  double overPlain() const { return static_cast<double>(edited.points + ofIndex()) / static_cast<double>(plain); }
};

/// What only a stroke in real time can tell; its ticks are all those at full depth, with an edit or without.
struct EditStroke {
  double rate_Hz = 0, duration_s = 0;
  double freshShare = 0, editsPerSecond = 0;
  std::uint64_t missedTicks = 0;  ///< left out because their time had passed
  std::uint64_t leftOut = 0;      ///< edits that there was no time or no room in the log for
  std::uint64_t heldUp = 0;       ///< edits that waited for a compaction
};

struct EditCost {
  std::string subject, brush, index;
  std::size_t points = 0;
  std::size_t asked = 0;  ///< points that an edit is to touch
  double brushRadius_mm = 0, spacing_mm = 0;
  Summary touched;   ///< points that edits changed, moved or took away
  Summary query_us;  ///< on the GPU, of the ticks with an edit; no samples where it was not measured
  Summary edit_us;   ///< on the GPU: brush, index, normals, log; where a driver tells no times, until it was seen done
  Summary indexed_us;   ///< in virtual time: query and edit of each tick together, on the GPU
  Summary requests_us;  ///< on the GPU, behind the edit: where points should come and go with the next one
  Summary step_us;      ///< from pose to force; in virtual time with the whole edit in it
  std::uint64_t edits = 0;
  std::uint64_t builds = 0;       ///< full builds of the index for these edits
  std::uint64_t compactions = 0;  ///< of the index in the background, that came out, among these ticks
  Summary compactingStep_us;  ///< of the steps, those while it was compacted; in virtual time with all of that in one
  double longestCompactionEnd_us = 0;  ///< that touch waited for the end of one, in all the session
  std::uint64_t landings = 0;          ///< how often the brush was put down
  EditMemory memory;
  std::optional<EditStroke> stroke;
};
Json toJson(const EditCost& cost);

/// Where an edit with a full build becomes cheaper than an update of the index.
struct EditCrossover {
  std::string subject;
  std::size_t points = 0;
  double share = 0;    ///< touched points over all points
  bool found = false;  ///< false: `share` is the largest one measured, and the update was still cheaper there
};
/// One for each model on which both ways were measured, of times on the GPU. Only updates count that needed no build.
std::vector<EditCrossover> crossovers(const std::vector<EditCost>& costs);
Json toJson(const EditCrossover& crossover);

/// How the edited step of the largest model compares to that of the smallest, for the same number of points asked.
struct EditGrowth {
  std::string index;
  std::size_t asked = 0, from = 0, to = 0;  ///< points asked; points of the two models
  double factor = 0;                        ///< of the median steps
};
std::vector<EditGrowth> growths(const std::vector<EditCost>& costs);
Json toJson(const EditGrowth& growth);

void printEditTables(std::FILE* out, const std::vector<EditCost>& costs);

}  // namespace palpate
