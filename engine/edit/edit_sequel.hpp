#pragma once

#include <cstdint>

#include "engine/edit/edit_log.hpp"
#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// The passes of an edit after the index update: they fit the normals of changed points and write the log entries.
class EditSequel {
 public:
  /// `radius`: support radius, model units. `update` and `log` must outlive it.
  EditSequel(Device& device, const HashUpdate& update, const EditLog& log, double radius);

  /// The changed slots, and room for a vec4 for each of them.
  struct Scratch {
    DeviceAddress changed = 0, fitted = 0;
  };
  struct Io {
    const shared::CloudView& cloud;
    std::uint32_t parity;
    DeviceAddress tables;
    DeviceAddress lists;  ///< of the resampling; 0 if points are not examined
    Scratch scratch;
  };
  /// `end`: completes the edit in the last of these passes, if no other pass follows.
  void record(CommandList& list, const Io& io, const shared::EditEnd& end) const;
  /// Logs the points that the committed moves remove, before the lists are cleared.
  void recordGone(CommandList& list, const Io& io) const;

 private:
  void recordLogging(CommandList& list, const ComputePipeline& pass, CountedDispatch::Step step, std::uint64_t groups,
                     const Io& io) const;

  const HashUpdate& update_;
  const EditLog& log_;
  double radius_;
  ComputePipeline refit_, logGone_, settle_;
};

}  // namespace palpate
