#include "engine/motion/pose_search_pass.hpp"

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/icp_passes.h"

namespace palpate {

namespace {

std::uint32_t groupsFor(const DepthCamera& camera, std::uint32_t stride) {
  const std::uint64_t columns = (camera.width + stride - 1) / stride, rows = (camera.height + stride - 1) / stride;
  const std::uint64_t perGroup = std::uint64_t{shared::kIcpWorkgroup} * shared::kIcpPixels;
  return static_cast<std::uint32_t>((columns * rows + perGroup - 1) / perGroup);
}

Buffer byPixel(Device& device, const DepthCamera& camera, std::uint64_t bytes, const char* name) {
  return Buffer(device, std::uint64_t{camera.width} * camera.height * bytes, Memory::device, name);
}

// Adds the sums of one workgroup.
void add(IcpSums& sums, std::span<const float> group) {
  std::size_t entry = 0;
  for (std::size_t i = 0; i < shared::kIcpUnknowns; ++i) {
    for (std::size_t j = i; j < shared::kIcpUnknowns; ++j) {
      const auto value = static_cast<double>(group[entry++]);
      sums.equations.matrix[i][j] += value;
      if (j != i) sums.equations.matrix[j][i] += value;
    }
    sums.equations.side[i] += static_cast<double>(group[shared::kIcpRightSide + i]);
  }
  sums.equations.weights += static_cast<double>(group[shared::kIcpWeights]);
  sums.equations.squares += static_cast<double>(group[shared::kIcpSquares]);
  sums.feigned += static_cast<double>(group[shared::kIcpFeigned]);
  sums.seen += static_cast<std::uint64_t>(group[shared::kIcpSeen]);
  sums.pairs += static_cast<std::uint64_t>(group[shared::kIcpPairs]);
}

}  // namespace

PoseSearchPass::PoseSearchPass(Device& device, Queue& queue, FusionPass& fusion, const LiveCloud& cloud)
    : device_(device),
      queue_(queue),
      fusion_(fusion),
      cloud_(cloud),
      frontPass_(device, shader_code::motion_map_front, {.pushBytes = sizeof(shared::MapFrontArgs)}),
      sumsPass_(device, shader_code::motion_icp_sums,
                {.workgroupSize = shared::kIcpWorkgroup, .pushBytes = sizeof(shared::IcpSumsArgs)}),
      query_(Buffer::of<shared::IcpView>(device, 1, Memory::upload, "icp query")),
      nearest_(byPixel(device, fusion.camera(), sizeof(std::uint32_t), "icp nearest")),
      ids_(byPixel(device, fusion.camera(), sizeof(std::uint32_t), "icp ids")),
      frontPlaces_(byPixel(device, fusion.camera(), sizeof(Vec4), "icp places")),
      frontNormals_(byPixel(device, fusion.camera(), sizeof(Vec4), "icp normals")),
      sums_(Buffer::of<float>(device, std::uint64_t{groupsFor(fusion.camera(), 1)} * shared::kIcpSums, Memory::readback,
                              "icp sums")) {}

// Recorded on demand: by then urgent work is announced to the device, and long dispatches are split for it.
const CommandList& PoseSearchPass::frontOf(std::uint32_t half) {
  auto& list = fronts_[half];
  if (list) return *list;
  list = std::make_unique<CommandList>(device_, queue_, "icp front");
  list->begin();
  {
    const auto overlap = list->independent();
    list->fill(nearest_, ~std::uint32_t{0}, nearest_.bytes());
    list->fill(ids_, shared::kEmptySlot, ids_.bytes());
    fusion_.recordSurfaces(*list);
  }
  const LiveCloud::Half& points = cloud_.half(half);
  for (const std::uint32_t turn : {shared::kFrontDepths, shared::kFrontIds, shared::kFrontPoints})
    list->dispatch(frontPass_, cloud_.slots(),
                   shared::MapFrontArgs{.view = fusion_.frame().view,
                                        .positions = points.positions.address(),
                                        .normals = points.normals.address(),
                                        .records = fusion_.records().address(),
                                        .nearest = nearest_.address(),
                                        .ids = ids_.address(),
                                        .frontPlaces = frontPlaces_.address(),
                                        .frontNormals = frontNormals_.address(),
                                        .slots = cloud_.slots(),
                                        .turn = turn});
  list->end();
  return *list;
}

const CommandList& PoseSearchPass::listFor(std::uint32_t stride) {
  auto& list = levels_[stride];
  if (list) return *list;
  const std::uint32_t groups = groupsFor(fusion_.camera(), stride);
  list = std::make_unique<CommandList>(device_, queue_, "icp sums");
  list->begin();
  list->dispatch(sumsPass_, std::uint64_t{groups} * shared::kIcpWorkgroup,
                 shared::IcpSumsArgs{.view = fusion_.frame().view,
                                     .query = query_.address(),
                                     .depths = fusion_.frame().depths,
                                     .surfaces = fusion_.frame().surfaces,
                                     .ids = ids_.address(),
                                     .frontPlaces = frontPlaces_.address(),
                                     .frontNormals = frontNormals_.address(),
                                     .sums = sums_.address(),
                                     .stride = stride,
                                     .groups = groups});
  list->end();
  return *list;
}

IcpResult PoseSearchPass::find(const FrameImages& images, const CameraPose& expected, const DVec3& origin,
                               const IcpOptions& options) {
  fusion_.setPose(images, expected, origin);
  queue_.run(frontOf(cloud_.parity()));
  return searchPose(images, expected, options, [&](const IcpQuery& query) { return sum(query, origin); });
}

IcpSums PoseSearchPass::sum(const IcpQuery& query, const DVec3& origin) {
  const auto axis = [&](const DVec3& direction) { return Vec3(query.pose.turn * direction); };
  query_.mapped<shared::IcpView>()[0] = {.right = axis({1, 0, 0}),
                                         .down = axis({0, 1, 0}),
                                         .ahead = axis({0, 0, 1}),
                                         .centre = Vec3(query.pose.centre - origin),
                                         .pivot = Vec3(query.pivot - origin),
                                         .scale = static_cast<float>(query.scale),
                                         .gate = static_cast<float>(query.level.gate_m)};
  queue_.run(listFor(query.level.stride));
  const std::uint32_t groups = groupsFor(fusion_.camera(), query.level.stride);
  const auto all = sums_.mapped<const float>();
  IcpSums sums;
  for (std::uint32_t group = 0; group < groups; ++group)
    add(sums, all.subspan(std::size_t{group} * shared::kIcpSums, shared::kIcpSums));
  return sums;
}

std::uint64_t PoseSearchPass::bytes() const {
  return nearest_.bytes() + ids_.bytes() + frontPlaces_.bytes() + frontNormals_.bytes();
}

}  // namespace palpate
