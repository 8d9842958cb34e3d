// The options that select and clean the points of a file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "engine/select/preparation.hpp"

namespace palpate {

struct PrepareOptions {
  Preparation preparation;
  std::string crop, cropOutside, outliers, radiusOutliers;  ///< as given; empty: not given

  /// Empty if no such option was given. Throws UsageError.
  std::optional<Preparation> given() const;
};
/// Joins `--outliers 8,1` to `--outliers=8,1`: its numbers may be left out, and the word behind a flag is a file.
void joinOutliers(std::vector<std::string>& arguments);
void addPrepareOptions(Options& command, PrepareOptions& options);

}  // namespace palpate
