#include "engine/render/water_pass.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/water.h"

namespace palpate {

namespace {

ComputePipeline waterPass(Device& device, const ShaderCode& code, std::vector<std::uint32_t> constants = {}) {
  return {
      device, code, {.workgroupSize = 64, .pushBytes = sizeof(shared::WaterArgs), .constants = std::move(constants)}};
}

}  // namespace

WaterPass::WaterPass(Device& device, const FrameSize& size)
    : pixels_(std::uint64_t{size.width} * size.height),
      samples_(pixels_ * size.supersample * size.supersample),
      balls_(waterPass(device, shader_code::render_water_balls)),
      alongRows_(waterPass(device, shader_code::render_water_smooth, {0})),
      alongColumns_(waterPass(device, shader_code::render_water_smooth, {1})),
      tidy_(waterPass(device, shader_code::render_water_tidy)),
      compose_(waterPass(device, shader_code::render_water_compose)),
      fronts_(deviceWords(device, pixels_, "nearest water")),
      sums_(deviceWords(device, pixels_, "thickness of water")),
      across_(Buffer::of<UVec2>(device, pixels_, Memory::device, "water smoothed along rows")),
      smoothed_(Buffer::of<UVec2>(device, pixels_, Memory::device, "smoothed water")),
      shaded_(deviceWords(device, 2 * samples_, "shaded water")),
      surface_(deviceWords(device, samples_, "depth with water")) {}

double WaterPass::unitsInLength(const Particles& particles) {
  // No sum may reach 2^32, even if all balls are behind one pixel, with the rounding of each.
  constexpr double kFinest = 1024, kLargest = 4e9;  // in a radius; of a sum
  const double share = particles.spacing / particles.radius;
  const double widest = 2 * std::max(share * share * share, 1.0);  // thickness of a ball, in radii
  return std::min(kFinest, (kLargest / std::max(particles.count, 1u) - 1) / widest) / particles.radius;
}

void WaterPass::record(CommandList& list, const Particles& particles, const Behind& behind) {
  const double ofBall = particles.spacing / particles.radius;
  const shared::WaterArgs args{.source = behind.source,
                               .depth = behind.depth,
                               .positions = particles.positions,
                               .fronts = fronts_.address(),
                               .sums = sums_.address(),
                               .across = across_.address(),
                               .smoothed = smoothed_.address(),
                               .behind = behind.shaded,
                               .shaded = shaded_.address(),
                               .surface = surface_.address(),
                               .count = particles.count,
                               .radius = static_cast<float>(particles.radius),
                               .share = static_cast<float>(ofBall * ofBall * ofBall * 0.75 / std::numbers::pi),
                               .unitsInLength = static_cast<float>(unitsInLength(particles)),
                               .side = static_cast<float>(std::max(particles.side, particles.radius)),
                               .unused = 0};
  const auto section = list.section("water");
  {
    const auto overlap = list.independent();
    list.fill(fronts_, shared::kNoDepth, fronts_.bytes());
    list.fill(sums_, 0, sums_.bytes());
  }
  list.dispatch(balls_, std::uint64_t{particles.count} * shared::kWaterWalkers, args);
  list.dispatch(alongRows_, pixels_, args);
  list.dispatch(alongColumns_, pixels_, args);
  list.dispatch(tidy_, pixels_, args);
  list.dispatch(compose_, samples_, args);
}

}  // namespace palpate
