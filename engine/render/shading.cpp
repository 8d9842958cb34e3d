#include "engine/render/shading.hpp"

#include "engine/gpu/device.hpp"
#include "engine/render/gaussian_pass.hpp"
#include "engine/render/ground.hpp"
#include "engine/render/relief.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/look.h"

namespace palpate {

Shading::Shading(Device& device, const FrameSize& size)
    : device_(device),
      size_(size),
      closeHoles_(device, shader_code::render_close_holes, {.pushBytes = sizeof(shared::CloseHolesArgs)}),
      smoothDepth_(device, shader_code::render_smooth_depth, {.pushBytes = sizeof(shared::SmoothDepthArgs)}),
      shade_(device, shader_code::render_shade, {.pushBytes = sizeof(shared::ShadeArgs), .constants = {0}}),
      resolve_(device, shader_code::render_resolve, {.pushBytes = sizeof(shared::ResolveArgs), .constants = {0}}),
      overlay_(device, shader_code::render_resolve, {.pushBytes = sizeof(shared::ResolveArgs), .constants = {1}}),
      smoothed_(deviceWords(device, 0, "frame smoothed depth")),
      source_(deviceWords(device, samples(), "frame source")),
      shaded_(deviceWords(device, 2 * samples(), "frame shaded")),
      image_(deviceWords(device, pixels(), "frame image")),
      depthImage_(deviceWords(device, pixels(), "frame depth image")) {}

Shading::~Shading() = default;

DeviceAddress Shading::recordSmoothing(CommandList& list, DeviceAddress depth) {
  if (smoothed_.bytes() == 0) smoothed_ = deviceWords(device_, samples(), "frame smoothed depth");
  const auto section = list.section("smooth");
  list.dispatch(smoothDepth_, samples(), shared::SmoothDepthArgs{.depth = depth, .smoothed = smoothed_.address()});
  return smoothed_.address();
}

void Shading::recordShade(CommandList& list, const RasterTarget& target, DeviceAddress depth, const Light& light) {
  Relief::Result relief;
  if (light.occlusion || light.cavity) {
    if (!relief_) relief_ = std::make_unique<Relief>(device_, size_);
    relief = relief_->record(list, target.normalSums, source_.address(), depth, light.occlusion, light.cavity);
  }
  const bool isPlain = light.material == Material::clay && relief.surfels == 0;
  if (!isPlain && !reliefShade_)
    reliefShade_.emplace(device_, shader_code::render_shade,
                         PipelineOptions{.pushBytes = sizeof(shared::ShadeArgs), .constants = {1}});
  list.dispatch(isPlain ? shade_ : *reliefShade_, samples(),
                shared::ShadeArgs{.source = source_.address(),
                                  .depth = depth,
                                  .normalSums = target.normalSums,
                                  .colorSums = target.colorSums,
                                  .shaded = shaded_.address(),
                                  .surfels = relief.surfels,
                                  .access = relief.access,
                                  .cavity = relief.cavity});
  if (!light.eyeDome) return;
  if (!eyeDome_)
    eyeDome_.emplace(device_, shader_code::render_eye_dome, PipelineOptions{.pushBytes = sizeof(shared::EyeDomeArgs)});
  list.dispatch(*eyeDome_, samples(),
                shared::EyeDomeArgs{.source = source_.address(), .depth = depth, .shaded = shaded_.address()});
}

void Shading::record(CommandList& list, const RasterTarget& target, const Camera& camera, const FrameOptions& options,
                     const Over& over) {
  {
    const auto section = list.section("holes");
    list.dispatch(closeHoles_, samples(), shared::CloseHolesArgs{.depth = target.depth, .source = source_.address()});
  }
  const DeviceAddress depth = options.smooth_px > 0 ? recordSmoothing(list, target.depth) : target.depth;
  const auto section = list.section("shade");
  recordShade(list, target, depth, options.pass == ImagePass::final ? options.light : Light());
  if (over.ground) over.ground->recordShadow(list, source_.address(), depth, shaded_.address(), samples());
  if (over.gaussians) over.gaussians->blend(list, shaded_.address());
  shared::ResolveArgs resolve{.source = source_.address(),
                              .depth = depth,
                              .shaded = shaded_.address(),
                              .image = image_.address(),
                              .depthImage = depthImage_.address(),
                              .first_px = {0, 0},
                              .size_px = {size_.width, size_.height}};
  if (over.water) {
    over.water->record(list, over.particles, {source_.address(), depth, shaded_.address()});
    resolve.source = 0;
    resolve.depth = over.water->surface().address();
    resolve.shaded = over.water->shaded().address();
  }
  list.dispatch(resolve_, pixels(), resolve);
  const PixelRectangle covered = overlayRectangle(options.overlays, camera, {size_.width, size_.height});
  resolve.first_px = covered.first_px;
  resolve.size_px = covered.size_px;
  list.dispatch(overlay_, std::uint64_t{covered.size_px.x} * covered.size_px.y, resolve);
  recordLines(list, camera, options);
}

void Shading::recordLines(CommandList& list, const Camera& camera, const FrameOptions& options) {
  if (!options.lines || options.lines->empty()) return;
  if (!lines_) lines_ = std::make_unique<LinePass>(device_, pixels());
  lines_->record(list, *options.lines, camera, {size_.width, size_.height},
                 {.depthImage = depthImage_.address(), .image = image_.address()});
}

}  // namespace palpate
