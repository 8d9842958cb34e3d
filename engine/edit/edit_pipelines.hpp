// How the passes of an edit are compiled.
#pragma once

#include "engine/gpu/compute_pipeline.hpp"
#include "engine/spatial/hash_update.hpp"

namespace palpate {

/// Options of a pass that iterates over the lists of an update; `pushBytes`: size of its push constants.
inline PipelineOptions editPipeline(std::uint32_t pushBytes, const HashUpdate& update) {
  return {.workgroupSize = shared::kUpdateWorkgroup,
          .pushBytes = pushBytes,
          .constants = {update.dispatch().countsGroups()}};
}

}  // namespace palpate
