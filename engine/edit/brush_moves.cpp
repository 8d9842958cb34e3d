#include "engine/edit/brush_moves.hpp"

#include <cmath>

#include "engine/core/brush_stroke.hpp"
#include "engine/core/check.hpp"
#include "engine/edit/edit_pipelines.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// In brush radii: the reach of a tool that is as long as its ball, and the maximum reach.
constexpr double kNear = 1.4, kFar = 2.5;

// Number of cells that a ball of `radius` may touch, along one side; 0 if there are more than the buckets.
std::uint64_t boxCells(const HashGrid& grid, double radius) {
  const double side = std::floor(2 * radius * static_cast<double>(grid.inverseCell)) + 3;
  return side * side * side > static_cast<double>(grid.bucketMask) ? 0 : static_cast<std::uint64_t>(side);
}

}  // namespace

BrushMoves::BrushMoves(Device& device, const HashUpdate& update, const HashGrid& grid, const BrushOptions& brush,
                       double radius)
    : device_(device),
      update_(update),
      grid_(grid),
      radius_(radius),
      options_(brush),
      collect_(device, shader_code::edit_collect, editPipeline(sizeof(shared::CollectArgs), update)),
      smooth_(device, shader_code::edit_smooth, editPipeline(sizeof(shared::SmoothArgs), update)),
      brush_(Buffer::of<shared::Brush>(device, 1, Memory::device, "brush")),
      tool_(Buffer::of<shared::PlacedTool>(device, 1, Memory::upload, "tool")) {
  setTool({});
  setBrush(brush);
}

void BrushMoves::setBrush(const BrushOptions& brush) {
  options_ = brush;
  boxCells_ = {boxCells(grid_, kNear * brush.radius), boxCells(grid_, kFar * brush.radius)};
  upload(device_, brush_, std::vector{sharedBrush(brush, radius_)});
}

void BrushMoves::setTool(const BrushStroke::Tool& tool) {
  tool_.mapped<shared::PlacedTool>()[0] = placedTool(tool);
  PALPATE_CHECK_LE(tool.reach, kFar * options_.radius * (1 + 1e-9));
  box_ = tool.reach > kNear * options_.radius * (1 - 1e-6) ? Box::far : Box::near;
}

BrushMoves::Selection BrushMoves::select(Box box, std::uint32_t slots) const {
  return has(box) ? Selection{.cells = static_cast<std::uint32_t>(cells(box))} : Selection{.slots = slots};
}

void BrushMoves::record(CommandList& list, const Io& io, const Selection& selection, std::uint32_t recalls) const {
  if (!brushHas(options_.kind, shared::kUsesNeighbours)) return recordCollect(list, io, selection, recalls);
  // All neighbours must still be at their old positions.
  recordCollect(list, io, selection, shared::kRecallsNothing);
  recordSmooth(list, io);
  if (recalls != shared::kRecallsNothing) recordRecalls(list, io, recalls);
}

void BrushMoves::recordRecalls(CommandList& list, const Io& io, std::uint32_t recalls) const {
  recordCollect(list, io, {}, recalls);
}

void BrushMoves::recordCollect(CommandList& list, const Io& io, const Selection& selection,
                               std::uint32_t recalls) const {
  const shared::HashUpdateArgs update = update_.args(io.cloud, io.parity);
  const std::uint32_t recalling =
      recalls == shared::kRecallsNothing ? 0 : update_.dispatch().sharedGroups(CountedDispatch::Step::subgroup);
  const std::uint64_t groups = std::uint64_t{shared::selectGroups(selection.cells, selection.slots)} + recalling;
  list.dispatch(collect_, groups * shared::kUpdateWorkgroup,
                shared::CollectArgs{.cloud = io.cloud,
                                    .update = update.update,
                                    .capacities = update.capacities,
                                    .tool = tool_.address(),
                                    .brush = brush_.address(),
                                    .tables = io.tables,
                                    .recalls = recalls,
                                    .cells = selection.cells,
                                    .firstSlot = selection.firstSlot,
                                    .slots = selection.slots});
}

void BrushMoves::recordSmooth(CommandList& list, const Io& io) const {
  const shared::HashUpdateArgs update = update_.args(io.cloud, io.parity);
  update_.dispatch()(list, smooth_, CountedDispatch::Step::subgroup, update_.counters(),
                     offsetof(shared::HashUpdate, movedGroups),
                     shared::SmoothArgs{.cloud = io.cloud,
                                        .update = update.update,
                                        .capacities = update.capacities,
                                        .tool = tool_.address(),
                                        .brush = brush_.address(),
                                        .tables = io.tables});
}

}  // namespace palpate
