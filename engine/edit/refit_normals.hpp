#pragma once

#include "engine/contact/contact_step.hpp"
#include "engine/edit/edit_log.hpp"

namespace palpate {

/// Gives every marked point the normal of its new surroundings and writes its move into the log. After one look at each
/// point's mark it costs by the number of moved points.
class RefitNormals {
 public:
  /// `points`: how many the cloud may have.
  RefitNormals(Device& device, std::uint32_t points);
  void record(CommandList& list, const shared::CloudView& cloud, const EditLog& log, double radius) const;

 private:
  std::uint32_t pointsPerGroup_, largestAxis_;
  ComputePipeline collect_, plan_, refit_;
  Buffer moved_, movedCount_, groups_;
};

}  // namespace palpate
