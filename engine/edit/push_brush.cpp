#include "engine/edit/push_brush.hpp"

#include "shaders/compiled.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

PushBrush::PushBrush(Device& device, const PushOptions& options)
    : options_(options), push_(device, shader_code::edit_push, {.pushBytes = sizeof(shared::PushArgs)}) {
  PALPATE_CHECK_LE(0.0, options.tau);
  PALPATE_CHECK_LE(0.0, options.beta);
  PALPATE_CHECK_LE(options.beta, 1.0);
  PALPATE_CHECK_LT(0.0, options.toolRadius);
}

void PushBrush::record(CommandList& list, const LiveCloud::Side& side, std::uint32_t count, const Buffer& contactState,
                       double longestMove) const {
  const auto section = list.section("push");
  list.dispatch(push_, count,
                shared::PushArgs{.positions = side.positions.address(),
                                 .normals = side.normals.address(),
                                 .state = contactState.address(),
                                 .count = count,
                                 .tau = static_cast<float>(options_.tau),
                                 .beta = static_cast<float>(options_.beta),
                                 .toolRadius = static_cast<float>(options_.toolRadius),
                                 .longestMove = static_cast<float>(longestMove),
                                 .unused = 0});
}

RefitNormals::RefitNormals(Device& device)
    : refit_(device, shader_code::edit_refit_normals, {.pushBytes = sizeof(shared::RefitNormalsArgs)}) {}

void RefitNormals::record(CommandList& list, const shared::CloudView& cloud, const EditLog& log, double radius) const {
  const auto section = list.section("refit normals");
  list.dispatch(refit_, cloud.count,
                shared::RefitNormalsArgs{.cloud = cloud,
                                         .entries = log.entries(),
                                         .head = log.head(),
                                         .capacityMask = static_cast<std::uint32_t>(log.capacity() - 1),
                                         .radius = static_cast<float>(radius)});
}

}  // namespace palpate
