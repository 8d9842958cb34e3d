#include "engine/render/frame.hpp"

#include <algorithm>
#include <cstring>

#include "engine/core/error.hpp"
#include "engine/gpu/device.hpp"
#include "engine/render/gaussian_pass.hpp"
#include "engine/render/ground.hpp"
#include "engine/render/water_pass.hpp"

namespace palpate {

namespace {

std::uint32_t checkedSide(std::uint32_t side) {
  if (side < 1 || side > kMaxSide_px) throw UsageError("size: {} pixels is not between 1 and {}", side, kMaxSide_px);
  return side;
}

}  // namespace

bool showsGaussians(const DrawnCloud& cloud, const FrameOptions& options) {
  const bool isOwnColor = options.color == ColorBy(ColorSource::rgb);
  const bool isPicture = options.pass == ImagePass::final || options.pass == ImagePass::color;
  return options.gaussians && cloud.gaussians() && isOwnColor && isPicture;
}

void Frame::checkSize(std::uint32_t width, std::uint32_t height) {
  checkedSide(width);
  checkedSide(height);
}

Frame::Frame(Device& device, std::uint32_t width, std::uint32_t height, std::uint32_t supersample, bool wideAtomics)
    : device_(device),
      size_{.width = checkedSide(width), .height = checkedSide(height), .supersample = std::clamp(supersample, 1u, 2u)},
      raster_(device, wideAtomics),
      triangles_(device),
      shading_(device, size_),
      constants_(device, sizeof(shared::RenderFrame), kInFlight, "frame constants"),
      depth_(deviceWords(device, samples(), "frame depth")),
      normalSums_(deviceWords(device, 4 * samples(), "frame normal sums")),
      colorSums_(deviceWords(device, 3 * samples(), "frame color sums")) {}

Frame::~Frame() = default;

void Frame::record(CommandList& list, const DrawnCloud& cloud, const Camera& camera, const FrameOptions& options) {
  const auto frame = list.section("frame");
  if (showsGaussians(cloud, options)) return recordGaussians(list, cloud, camera, options);
  const Drawn about = drawn(cloud, options);
  const RasterTarget target = begin(list, about, camera, options, 0);
  const Ground* const under = ground(list, cloud, about, options);
  if (options.raster != Raster::compute) {
    recordHardware(list, cloud, target, about, camera, options);
  } else {
    recordClear(list, about.hasColors);
    raster_.record(list, cloud, target);
  }
  if (about.firstDisc == 0) return shading_.record(list, target, camera, options, {.ground = under});
  if (!water_) water_ = std::make_unique<WaterPass>(device_, size_);
  shading_.record(list, target, camera, options,
                  {.ground = under,
                   .water = water_.get(),
                   .particles = {.positions = cloud.positions().address(),
                                 .count = about.firstDisc,
                                 .radius = options.particles.radius,
                                 .spacing = options.particles.spacing,
                                 .side = options.shown.value_or(about.bounds).longestSide()}});
}

void Frame::record(CommandList& list, DrawnMesh mesh, const Camera& camera, const FrameOptions& options) {
  mesh.hasColors &= options.color != ColorBy(ColorSource::material);
  const Drawn about = drawn(mesh);
  const std::uint32_t tiles = tilesOf(about, camera, size_px().y);
  const RasterTarget target = begin(list, about, camera, options, tiles);
  const auto frame = list.section("frame");
  const Ground* const under = ground(list, mesh, about, options);
  recordClear(list, mesh.hasColors);
  {
    const auto section = list.section("triangles");
    triangles_.record(list, mesh, tiles, target);
  }
  shading_.record(list, target, camera, options, {.ground = under});
}

template <class Cloud>
const Ground* Frame::ground(CommandList& list, const Cloud& cloud, const Drawn& about, const FrameOptions& options) {
  if (!options.light.ground || options.pass != ImagePass::final) return nullptr;
  if (!ground_) ground_ = std::make_unique<Ground>(device_);
  ground_->follow(list, cloud, groundMap(options.shown.value_or(about.bounds), options.up, about.spacing));
  return ground_.get();
}

void Frame::recordHardware(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target, const Drawn& about,
                           const Camera& camera, const FrameOptions& options) {
  if (!hardware_) hardware_ = std::make_unique<HardwareRaster>(device_, size_px());
  const auto section = list.section("splat");
  hardware_->record(list, cloud, target, frameConstants(about, camera, options, size_, 0), 2 * about.widestSplat);
}

void Frame::recordGaussians(CommandList& list, const DrawnCloud& cloud, const Camera& camera, FrameOptions options) {
  if (!gaussians_) gaussians_ = std::make_unique<GaussianPass>(device_);
  options.light = {.ground = options.light.ground};  // theirs was trained
  options.smooth_px = 0;
  options.closeHoles = false;
  const Drawn about = drawn(cloud, options);
  const RasterTarget target = begin(list, about, camera, options, 0);
  const Ground* const under = ground(list, cloud, about, options);
  list.fill(depth_, shared::kNoDepth, depth_.bytes());
  gaussians_->prepare(list, cloud, target, size_);
  shading_.record(list, target, camera, options, {.ground = under, .gaussians = gaussians_.get()});
}

void Frame::recordClear(CommandList& list, bool colors) const {
  const auto section = list.section("clear");
  const auto overlap = list.independent();
  list.fill(depth_, shared::kNoDepth, depth_.bytes());
  list.fill(normalSums_, 0, normalSums_.bytes());
  if (colors) list.fill(colorSums_, 0, colorSums_.bytes());
}

RasterTarget Frame::begin(CommandList& list, const Drawn& about, const Camera& camera, const FrameOptions& options,
                          std::uint32_t tiles) {
  const std::uint32_t slot = recordings_++ % kInFlight;
  constants_.write(slot, frameConstants(about, camera, options, size_, tiles));
  list.use(constants_, slot);
  return {.depth = depth_.address(), .normalSums = normalSums_.address(), .colorSums = colorSums_.address()};
}

void Frame::readBack(const Buffer& from, std::span<std::byte> to) const {
  const Buffer staging(device_, to.size(), Memory::readback, "read back " + from.name());
  CommandList list(device_, device_.throughputQueue(), "read back " + from.name());
  list.begin();
  list.copy(from, staging, to.size());
  list.end();
  device_.throughputQueue().run(list);
  std::memcpy(to.data(), staging.mapped<std::byte>().data(), to.size());
}

Image Frame::readColor() const {
  Image image{width(), height(), {}};
  image.rgba.resize(std::size_t{width()} * height());
  readBack(shading_.image(), std::as_writable_bytes(std::span(image.rgba)));
  return image;
}

std::uint32_t Frame::readDiscs() const {
  const shared::SplatCounts counts = raster_.readCounts();
  return counts.small + counts.large;
}

DepthImage Frame::readDepth() const {
  DepthImage image{width(), height(), {}};
  image.depth.resize(std::size_t{width()} * height());
  readBack(shading_.depthImage(), std::as_writable_bytes(std::span(image.depth)));
  return image;
}

}  // namespace palpate
