#pragma once

#include <cstdint>

#include "engine/edit/edit_log.hpp"
#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// The passes of an edit once the index has followed: the normals of what changed are fitted, the log gets its entries.
class EditSequel {
 public:
  /// `radius`: support radius, model units. `update` and `log` must outlive it.
  EditSequel(Device& device, const HashUpdate& update, const EditLog& log, double radius);

  /// The slots that have changed, and room for a vec4 for each of them.
  struct Scratch {
    DeviceAddress changed = 0, fitted = 0;
  };
  struct Io {
    const shared::CloudView& cloud;
    std::uint32_t parity;
    DeviceAddress tables;
    DeviceAddress lists;  ///< of the resampling; 0 where there is none
    Scratch scratch;
  };
  /// `end`: what the last of these passes does besides, where no other follows.
  void record(CommandList& list, const Io& io, const shared::EditEnd& end) const;
  /// Points that the committed moves take away go to the log, before the lists are emptied.
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
