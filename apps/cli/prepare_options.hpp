// The options that select and clean the points of a file.
#pragma once

#include <optional>
#include <string>

#include "apps/cli/options.hpp"
#include "engine/select/preparation.hpp"

namespace palpate {

struct PrepareOptions {
  Preparation preparation;
  std::string crop, cropOutside, outliers, radiusOutliers;  ///< as given; empty: not given

  /// Empty if no such option was given. Throws UsageError.
  std::optional<Preparation> given() const;
};
void addPrepareOptions(Options& command, PrepareOptions& options);

}  // namespace palpate
