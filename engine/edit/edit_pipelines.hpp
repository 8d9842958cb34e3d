// How the passes of an edit are compiled.
#pragma once

#include "engine/gpu/compute_pipeline.hpp"
#include "engine/spatial/hash_update.hpp"

namespace palpate {

/// Of a pass that walks over the lists of an update; `pushBytes`: of its push constants.
inline PipelineOptions editPipeline(std::uint32_t pushBytes, const HashUpdate& update) {
  return {.workgroupSize = shared::kUpdateWorkgroup,
          .pushBytes = pushBytes,
          .constants = {update.dispatch().countsGroups()}};
}

}  // namespace palpate
