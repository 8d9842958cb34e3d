// Results of `bench locality`: one record for each stroke, their table, and the promises of an edit that they break.
#pragma once

#include "apps/cli/context.hpp"
#include "engine/study/edit_judge.hpp"

namespace palpate {

/// A brush without effect pressed into the surface must change nothing.
struct IdleRecord {
  std::size_t ticks = 0;  ///< ticks in which the brush acted
  std::size_t moved = 0, inserted = 0, removed = 0;

  bool changed() const { return moved + inserted + removed > 0; }
};

struct StrokeRecord {
  std::string subject, backend, brush, gesture;
  std::size_t points = 0;
  double spacing_mm = 0, radius_mm = 0, brushRadius_mm = 0;  ///< radius_mm: support radius of the edits
  std::size_t ticks = 0, acting = 0;                         ///< ticks of the stroke; those in which the brush acted
  std::size_t settling = 0;                                  ///< ticks in the air until the last change
  bool settled = true;                                       ///< false: it still changed at the last tick observed
  bool carves = false;
  IdleRecord before, after;  ///< presses on the cloud before the stroke, and on the settled one
  EditVerdict verdict;
  double deepest_mm = 0, highest_mm = 0;  ///< largest distance of changed points under and over the surface before

  /// Broken promises in words, including those of EditVerdict; empty without any. `strict`: as there.
  std::vector<std::string_view> broken(bool strict = false) const;
};

struct LocalityResults {
  std::vector<StrokeRecord> strokes;

  /// Strokes that broke a promise. `strict`: as there.
  std::size_t broken(bool strict = false) const;
};
Json toJson(const LocalityResults& results);

/// The table is printed row by row: a stroke may take minutes.
void printStrokeHeading(std::FILE* out);
void printStroke(std::FILE* out, const StrokeRecord& record);

}  // namespace palpate
