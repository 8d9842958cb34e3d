// What a touch side on the GPU is made with.
#pragma once

#include <optional>
#include <vector>

#include "engine/contact/contact_step.hpp"
#include "engine/core/tool_shape.hpp"
#include "engine/edit/edit_pass.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/motion/fused_stream.hpp"
#include "engine/touch/live_index.hpp"

namespace palpate {

struct TouchOptions {
  double radius = 0;  ///< support radius, model units
  double cell = 0;    ///< edge of a hash cell, model units; 0: the support radius
  BucketKey bucketKey = BucketKey::teschner;
  SortMethod sort = kDefaultSort;                 ///< of the index
  BucketOrder bucketOrder = BucketOrder::stable;  ///< stable: the same poses give the same answers, bit by bit
  QueryMethod method = QueryMethod::fused;
  SurfaceKind surface = SurfaceKind::average;
  bool localRadius = false;   ///< take a smaller support radius where points lie close (SurfaceOptions)
  double widening = 1;        ///< of the support radius, where the surface is flat; edits are narrow
  double friction = 0;        ///< coefficient, of a proxy that slides
  std::optional<bool> split;  ///< fused: whether a few workgroups share a gather (ContactOptions)
  /// What each hand touches with, model units; one hand with the HIP alone unless given. The first one may have a
  /// brush. More than one HIP only fused.
  std::vector<ToolShape> tools = std::vector<ToolShape>(1);
  std::optional<BrushOptions> brush;  ///< edit while touching, where the HIP itself does
  CloudSource* source = nullptr;      ///< moves the points, which have no brush then; outlives what it moves
  std::optional<PointExtent>
      extent;  ///< of all points, where the cloud and the frames are a part of them: of their grid
  /// In place of a source: the points are a map that depth frames fuse into, which begins with the cloud.
  std::optional<FusedStream> fusion;
  bool paintable = false;  ///< keeps colours, for a brush that comes later
  IndexFollow index = IndexFollow::incremental;
  std::optional<std::uint32_t>
      spareSlots;  ///< where the index follows edits; in proportion to the cloud when not given
  CompactionOptions compaction;
  std::optional<Wait> wait;   ///< how the servo thread waits for the GPU; the device's default when not given
  std::optional<bool> ahead;  ///< submit each question before its pose is known (TouchSide); where not given, on
                              ///< drivers that are known to let it wait, if it does
  CommandList::Timing timing = CommandList::Timing::sections;
};

}  // namespace palpate
