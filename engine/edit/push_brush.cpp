#include "engine/edit/push_brush.hpp"

#include "shaders/compiled.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

PushBrush::PushBrush(Device& device, const BrushOptions& options)
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

}  // namespace palpate
