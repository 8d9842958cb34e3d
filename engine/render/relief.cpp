#include "engine/render/relief.hpp"

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/look.h"

namespace palpate {

Relief::Relief(Device& device, const FrameSize& size)
    : pixels_(std::uint64_t{size.width} * size.height),
      gather_(device, shader_code::render_surfels, {.pushBytes = sizeof(shared::SurfelArgs)}),
      occlude_(device, shader_code::render_occlusion, {.pushBytes = sizeof(shared::OcclusionArgs)}),
      blur_(device, shader_code::render_blur_occlusion, {.pushBytes = sizeof(shared::OcclusionArgs)}),
      bend_(device, shader_code::render_cavity, {.pushBytes = sizeof(shared::CavityArgs)}),
      surfels_(Buffer::of<UVec2>(device, pixels_, Memory::device, "surfels")),
      rough_(deviceWords(device, pixels_, "occlusion before its blur")),
      access_(deviceWords(device, pixels_, "occlusion")),
      cavity_(deviceWords(device, pixels_, "cavities")) {}

Relief::Result Relief::record(CommandList& list, DeviceAddress normalSums, DeviceAddress source, DeviceAddress depth,
                              bool occlusion, bool cavity) {
  Result result;
  if (!occlusion && !cavity) return result;
  result.surfels = surfels_.address();
  const auto section = list.section("relief");
  list.dispatch(
      gather_, pixels_,
      shared::SurfelArgs{.source = source, .depth = depth, .normalSums = normalSums, .surfels = surfels_.address()});
  if (occlusion) {
    shared::OcclusionArgs args{.surfels = surfels_.address(), .from = 0, .to = rough_.address()};
    list.dispatch(occlude_, pixels_, args);
    args.from = rough_.address();
    args.to = result.access = access_.address();
    list.dispatch(blur_, pixels_, args);
  }
  if (cavity) {
    result.cavity = cavity_.address();
    list.dispatch(bend_, pixels_, shared::CavityArgs{.surfels = surfels_.address(), .cavity = result.cavity});
  }
  return result;
}

}  // namespace palpate
