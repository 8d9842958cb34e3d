#pragma once

#include <array>
#include <cstdint>

#include "engine/core/brush.hpp"
#include "engine/core/brush_stroke.hpp"
#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// The first passes of an edit: they list the moves of the points in a brush's reach, and those from the requests that
/// points made in the last tick.
class BrushMoves {
 public:
  /// `radius`: support radius, model units. `update` must outlive it.
  BrushMoves(Device& device, const HashUpdate& update, const HashGrid& grid, const BrushOptions& brush, double radius);

  /// Replaces the brush: lists recorded with the previous one must be recorded again.
  void setBrush(const BrushOptions& brush);
  const BrushOptions& brush() const { return options_; }
  /// Address for shaders.
  DeviceAddress address() const { return brush_.address(); }
  DeviceAddress tool() const { return tool_.address(); }
  /// Sets the tool of the edit that is submitted next. Not during an edit.
  void setTool(const BrushStroke::Tool& tool);

  /// The boxes in which a brush searches for points: one around its ball and the hand's surroundings, and one around a
  /// tool with a longer reach.
  enum class Box { near, far };
  /// The box that the current tool requires.
  Box box() const { return box_; }

  /// The search range of a brush: the cells of a box, a range of slots, or nothing.
  struct Selection {
    std::uint32_t cells = 0, firstSlot = 0, slots = 0;
  };
  /// Whether a box has fewer cells than there are buckets.
  bool has(Box box) const { return cells(box) > 0; }
  /// The box; if it has too many cells, all of the given slots.
  Selection select(Box box, std::uint32_t slots) const;

  /// Inputs.
  struct Io {
    const shared::CloudView& cloud;
    std::uint32_t parity;
    DeviceAddress tables;
  };
  // `recalls`: kRecalls... of shaders/shared/edit.h.
  /// Records the moves of the brush and those of requests.
  void record(CommandList& list, const Io& io, const Selection& selection, std::uint32_t recalls) const;
  /// Records those of the requests alone.
  void recordRecalls(CommandList& list, const Io& io, std::uint32_t recalls) const;

  std::uint64_t bytes() const { return brush_.bytes() + tool_.bytes(); }

 private:
  std::uint64_t cells(Box box) const { return boxCells_[static_cast<std::size_t>(box)]; }
  void recordCollect(CommandList& list, const Io& io, const Selection& selection, std::uint32_t recalls) const;
  void recordSmooth(CommandList& list, const Io& io) const;

  Device& device_;
  const HashUpdate& update_;
  HashGrid grid_;
  double radius_;
  BrushOptions options_;
  std::array<std::uint64_t, 2> boxCells_{};  // along one side; 0: a pass over all slots costs less
  Box box_ = Box::near;
  ComputePipeline collect_, smooth_;
  Buffer brush_, tool_;
};

}  // namespace palpate
