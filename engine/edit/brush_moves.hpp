#pragma once

#include <array>
#include <cstdint>

#include "engine/core/brush.hpp"
#include "engine/core/brush_stroke.hpp"
#include "engine/spatial/hash_update.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

/// The first passes of an edit: they list the moves of the points that a brush reaches, and those of the requests that
/// points made in the last tick.
class BrushMoves {
 public:
  /// `radius`: support radius, model units. `update` must outlive it.
  BrushMoves(Device& device, const HashUpdate& update, const HashGrid& grid, const BrushOptions& brush, double radius);

  /// Another brush from now on: what was recorded with the one before must be recorded again.
  void setBrush(const BrushOptions& brush);
  const BrushOptions& brush() const { return options_; }
  /// As shaders read it.
  DeviceAddress address() const { return brush_.address(); }
  DeviceAddress tool() const { return tool_.address(); }
  /// Where the tool is in the edit that is submitted next. While none is under way.
  void setTool(const BrushStroke::Tool& tool);

  /// The boxes in which a brush looks for points: one around its ball and what is near the hand, and one
  /// around a tool that reaches further.
  enum class Box { near, far };
  /// The one that the tool asks for.
  Box box() const { return box_; }

  /// Where a brush looks for points: in the cells of a box, in slots, or nowhere.
  struct Selection {
    std::uint32_t cells = 0, firstSlot = 0, slots = 0;
  };
  /// Whether a box has fewer cells than there are buckets.
  bool has(Box box) const { return cells(box) > 0; }
  /// The box; where it has too many cells, all of so many slots.
  Selection select(Box box, std::uint32_t slots) const;

  /// Which points.
  struct Io {
    const shared::CloudView& cloud;
    std::uint32_t parity;
    DeviceAddress tables;
  };
  // `recalls`: kRecalls... of shaders/shared/edit.h.
  /// The moves of the brush, and those of requests.
  void record(CommandList& list, const Io& io, const Selection& selection, std::uint32_t recalls) const;
  /// Those of the requests alone.
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
