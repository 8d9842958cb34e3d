#include "engine/render/frame.hpp"

#include <algorithm>
#include <cstring>

#include "engine/core/error.hpp"
#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kLargestSide_px = 16'384;
// Small workgroups: a workgroup lives as long as its largest triangle, and the touch side may be waiting for its place.
constexpr std::uint32_t kTriangleWorkgroup = 64;

std::uint32_t checkedSide(std::uint32_t side) {
  if (side < 1 || side > kLargestSide_px)
    throw UsageError("--size: {} pixels is not between 1 and {}", side, kLargestSide_px);
  return side;
}

Buffer words(Device& device, std::uint64_t count, const char* name) {
  return Buffer::of<std::uint32_t>(device, count, Memory::device, name);
}

}  // namespace

void Frame::checkSize(std::uint32_t width, std::uint32_t height) {
  checkedSide(width);
  checkedSide(height);
}

Frame::Frame(Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t supersample, bool wideAtomics)
    : device_(device),
      width_(checkedSide(width)),
      height_(checkedSide(height)),
      supersample_(std::clamp(supersample, 1u, 2u)),
      raster_(device, wideAtomics),
      triangleDepth_(device, shader_code::render_triangle_depth,
                     {.workgroupSize = kTriangleWorkgroup, .pushBytes = sizeof(shared::TriangleArgs)}),
      triangleAttributes_(device, shader_code::render_triangle_attributes,
                          {.workgroupSize = kTriangleWorkgroup, .pushBytes = sizeof(shared::TriangleArgs)}),
      closeHoles_(device, shader_code::render_close_holes, {.pushBytes = sizeof(shared::CloseHolesArgs)}),
      smoothDepth_(device, shader_code::render_smooth_depth, {.pushBytes = sizeof(shared::SmoothDepthArgs)}),
      shade_(device, shader_code::render_shade, {.pushBytes = sizeof(shared::ShadeArgs)}),
      resolve_(device, shader_code::render_resolve, {.pushBytes = sizeof(shared::ResolveArgs), .constants = {0}}),
      overlay_(device, shader_code::render_resolve, {.pushBytes = sizeof(shared::ResolveArgs), .constants = {1}}),
      constants_(Buffer::of<shared::RenderFrame>(device, kInFlight, Memory::upload, "frame constants")),
      depth_(words(device, samples(), "frame depth")),
      smoothed_(words(device, 0, "frame smoothed depth")),
      normalSums_(words(device, 4 * samples(), "frame normal sums")),
      colorSums_(words(device, 3 * samples(), "frame color sums")),
      source_(words(device, samples(), "frame source")),
      shaded_(words(device, 2 * samples(), "frame shaded")),
      image_(words(device, std::uint64_t{width_} * height_, "frame image")),
      depthImage_(words(device, std::uint64_t{width_} * height_, "frame depth image")) {}

void Frame::record(CommandList& list, const DrawnCloud& cloud, const Camera& camera, const FrameOptions& options) {
  const Drawn about = drawn(cloud, options);
  const DeviceAddress constants = writeConstants(about, camera, options, 0);
  const auto frame = list.section("frame");
  if (options.raster != Raster::compute) {
    recordHardware(list, cloud, constants, about, camera, options);
    return recordShading(list, constants, camera, options);
  }
  recordClear(list, cloud.hasColors());
  raster_.record(list, cloud, target(constants));
  recordSources(list, constants);
  recordShading(list, constants, camera, options);
}

void Frame::record(CommandList& list, const DrawnMesh& mesh, const Camera& camera, const FrameOptions& options) {
  const Drawn about = drawn(mesh);
  const std::uint32_t tiles = tilesOf(about, camera, size_px().y);
  const DeviceAddress constants = writeConstants(about, camera, options, tiles);
  const std::uint64_t shares = std::uint64_t{mesh.triangleCount} * tiles * tiles;
  const shared::TriangleArgs args{.frame = constants,
                                  .vertices = mesh.vertices,
                                  .triangles = mesh.triangles,
                                  .depth = depth_.address(),
                                  .normalSums = normalSums_.address(),
                                  .colorSums = colorSums_.address()};
  const auto frame = list.section("frame");
  recordClear(list, mesh.hasColors);
  {
    const auto section = list.section("triangles");
    list.dispatch(triangleDepth_, shares, args);
    list.dispatch(triangleAttributes_, shares, args);
  }
  recordSources(list, constants);
  recordShading(list, constants, camera, options);
}

void Frame::recordHardware(CommandList& list, const DrawnCloud& cloud, DeviceAddress constants, const Drawn& about,
                           const Camera& camera, const FrameOptions& options) {
  if (!hardware_) hardware_ = std::make_unique<HardwareRaster>(device_, size_px());
  {
    const auto section = list.section("splat");
    hardware_->record(
        list, cloud, target(constants),
        frameConstants(about, camera, options, {.width = width_, .height = height_, .supersample = supersample_}, 0),
        2 * about.widestSplat);
  }
  recordSources(list, constants);
}

void Frame::recordClear(CommandList& list, bool colors) const {
  const auto section = list.section("clear");
  const auto overlap = list.independent();
  list.fill(depth_, shared::kNoDepth, depth_.bytes());
  list.fill(normalSums_, 0, normalSums_.bytes());
  if (colors) list.fill(colorSums_, 0, colorSums_.bytes());
}

void Frame::recordSources(CommandList& list, DeviceAddress constants) const {
  const auto section = list.section("holes");
  list.dispatch(closeHoles_, samples(),
                shared::CloseHolesArgs{.frame = constants, .depth = depth_.address(), .source = source_.address()});
}

void Frame::recordShading(CommandList& list, DeviceAddress constants, const Camera& camera,
                          const FrameOptions& options) {
  const bool smooths = options.smooth_px > 0;
  if (smooths) {
    if (smoothed_.bytes() == 0) smoothed_ = words(device_, samples(), "frame smoothed depth");
    const auto section = list.section("smooth");
    list.dispatch(
        smoothDepth_, samples(),
        shared::SmoothDepthArgs{.frame = constants, .depth = depth_.address(), .smoothed = smoothed_.address()});
  }
  const DeviceAddress depth = smooths ? smoothed_.address() : depth_.address();
  const auto section = list.section("shade");
  list.dispatch(shade_, samples(),
                shared::ShadeArgs{.frame = constants,
                                  .source = source_.address(),
                                  .depth = depth,
                                  .normalSums = normalSums_.address(),
                                  .colorSums = colorSums_.address(),
                                  .shaded = shaded_.address()});
  shared::ResolveArgs resolve{.frame = constants,
                              .source = source_.address(),
                              .depth = depth,
                              .shaded = shaded_.address(),
                              .image = image_.address(),
                              .depthImage = depthImage_.address(),
                              .first_px = {0, 0},
                              .size_px = {width_, height_}};
  list.dispatch(resolve_, std::uint64_t{width_} * height_, resolve);
  const PixelRectangle over = overlayRectangle(options.overlays, camera, {width_, height_});
  resolve.first_px = over.first_px;
  resolve.size_px = over.size_px;
  list.dispatch(overlay_, std::uint64_t{over.size_px.x} * over.size_px.y, resolve);
}

DeviceAddress Frame::writeConstants(const Drawn& about, const Camera& camera, const FrameOptions& options,
                                    std::uint32_t tiles) {
  const std::uint32_t slot = recordings_++ % kInFlight;
  constants_.mapped<shared::RenderFrame>()[slot] =
      frameConstants(about, camera, options, {.width = width_, .height = height_, .supersample = supersample_}, tiles);
  return constants_.address() + slot * sizeof(shared::RenderFrame);
}

void Frame::readBack(const Buffer& from, std::span<std::byte> to) const {
  const Buffer staging(device_, to.size(), Memory::readback, "read back " + from.name());
  CommandList list(device_, device_.sight(), "read back " + from.name());
  list.begin();
  list.copy(from, staging, to.size());
  list.end();
  device_.sight().run(list);
  std::memcpy(to.data(), staging.mapped<std::byte>().data(), to.size());
}

Image Frame::readColor() const {
  Image image{width_, height_, {}};
  image.rgba.resize(std::size_t{width_} * height_);
  readBack(image_, std::as_writable_bytes(std::span(image.rgba)));
  return image;
}

std::uint32_t Frame::readDiscs() const {
  const shared::SplatCounts counts = raster_.readCounts();
  return counts.small + counts.large;
}

DepthImage Frame::readDepth() const {
  DepthImage image{width_, height_, {}};
  image.depth.resize(std::size_t{width_} * height_);
  readBack(depthImage_, std::as_writable_bytes(std::span(image.depth)));
  return image;
}

}  // namespace palpate
