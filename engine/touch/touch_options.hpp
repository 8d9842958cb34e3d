// Options of the touch side on the GPU.
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
  SortMethod sort = kDefaultSort;                 ///< sort of the index build
  BucketOrder bucketOrder = BucketOrder::stable;  ///< stable: the same poses give bitwise identical answers
  QueryMethod method = QueryMethod::fused;
  SurfaceKind surface = SurfaceKind::average;
  bool localRadius = false;   ///< take a smaller support radius where points lie close (SurfaceOptions)
  double widening = 1;        ///< factor on the support radius for flat surfaces; edits use the unwidened radius
  double friction = 0;        ///< friction coefficient of the proxy
  std::optional<bool> split;  ///< fused: whether several workgroups share a gather (ContactOptions)
  /// Tool of each hand, model units; default: one hand, HIP only. Only the first hand may have a brush. More than one
  /// HIP requires the fused method.
  std::vector<ToolShape> tools = std::vector<ToolShape>(1);
  std::optional<BrushOptions> brush;  ///< edit while touching, at the HIP
  CloudSource* source = nullptr;      ///< moves the points and excludes a brush; must outlive the touch side
  std::optional<PointExtent>
      extent;  ///< extent of all points for the grid, if the cloud and the frames hold only part of them
  /// Alternative to a source: the points are a map into which depth frames are fused; its initial state is the cloud.
  std::optional<FusedStream> fusion;
  bool paintable = false;  ///< keeps colours for a paint brush set later
  IndexFollow index = IndexFollow::incremental;
  std::optional<std::uint32_t>
      spareSlots;  ///< spare slots of an index that follows edits; default: proportional to the cloud
  CompactionOptions compaction;
  std::optional<Wait> wait;   ///< how the servo thread waits for the GPU; default: the device's
  std::optional<bool> ahead;  ///< submit each question before its pose is known (TouchSide); default: on drivers known
                              ///< to support it, if a test at startup succeeds
  CommandList::Timing timing = CommandList::Timing::sections;
};

}  // namespace palpate
