// A far cloud whose points are sent in bricks.
#pragma once

#include <memory>

#include "haptics/session/far_cloud.hpp"
#include "haptics/sharing/brick_source.hpp"

namespace palpate {

class BrickCloud : public FarCloud {
 public:
  /// Source through which the points are requested and felt.
  virtual BrickSource& source() = 0;
  std::unique_ptr<FarTouch> makeTouch(const BackendSetup& setup) override;
};

/// Feels matter that another program simulates, by the forces that it sends. Throws Error if this palpate was built
/// without simulation.
std::unique_ptr<FarTouch> feelMatter(BrickSource& source, const InformationAge& known, const BackendSetup& setup);

}  // namespace palpate
