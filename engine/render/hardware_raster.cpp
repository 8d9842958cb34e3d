#include "engine/render/hardware_raster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/error.hpp"
#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
// Half floats would lose the colours of crowds: 2048 + 1 is 2048.
constexpr VkFormat kSumFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

// Maximum number in one draw; bounds the size of discs on screen.
constexpr std::uint32_t kMaxSprites = 1u << 26;

constexpr const char* kInstead = "; --raster compute works on any GPU";

Device& checkedFor(Device& device, const UVec2& size_px) {
  if (!device.draws())
    throw UsageError(
        "raster: {} has no graphics queue, cannot draw large points, or hangs when it draws under --validate{}",
        device.name(), kInstead);
  if (!Attachment::supports(device, kDepthFormat) || !Attachment::supports(device, kSumFormat))
    throw UsageError("raster: {} cannot blend 32-bit floats{}", device.name(), kInstead);
  const VkPhysicalDeviceLimits& limits = device.properties().limits;
  const std::uint32_t widest =
      std::min({limits.maxImageDimension2D, limits.maxFramebufferWidth, limits.maxFramebufferHeight,
                limits.maxViewportDimensions[0], limits.maxViewportDimensions[1]});
  if (std::max(size_px.x, size_px.y) > widest)
    throw UsageError("size: {} x {} samples exceed the maximum of {} on a side of {}{}", size_px.x, size_px.y, widest,
                     device.name(), kInstead);
  return device;
}

GraphicsPipeline pipeline(Device& device, const ShaderCode& fragment, std::vector<VkFormat> colors) {
  return {device,
          shader_code::render_hardware_disc,
          fragment,
          {.topology = VK_PRIMITIVE_TOPOLOGY_POINT_LIST,
           .depth = colors.empty() ? DepthUse::nearest : DepthUse::within,
           .depthFormat = kDepthFormat,
           .colorFormats = std::move(colors),
           .pushBytes = sizeof(shared::HardwareDiscArgs)}};
}

// Exponent of a power of two far above every depth, also of points that edits have moved off the cloud.
int depthExponent(const shared::RenderFrame& frame, double widest) {
  constexpr int kRoom = 6;
  const double deepest = frame.depthMax + widest;
  return std::ilogb(deepest > frame.view.nearDepth && std::isfinite(deepest) ? deepest : frame.view.nearDepth) + kRoom;
}

// Sprites along each side of the largest disc's box, limited by kMaxSprites; the rest is cut off. The near end of a
// disc has a smaller depth than its centre, and away from the picture's centre a box is wider than the disc: twice the
// size is a safe bound.
std::uint32_t spritesOf(std::uint32_t tile_px, const shared::RenderFrame& frame, double widest) {
  const double picture = std::max(frame.view.size_px.x, frame.view.size_px.y);
  const double nearest = std::max(frame.depthMin - widest, double{frame.view.nearDepth});
  const double aside = 0.5 * picture / frame.view.focal_px;
  const double side_px = std::min(2 * (1 + aside) * widest * frame.view.focal_px / nearest + 2, picture);
  const double affordable = std::floor(std::sqrt(double{kMaxSprites} / std::max(frame.count, 1u)));
  return static_cast<std::uint32_t>(std::clamp(std::ceil(side_px / tile_px), 1.0, std::max(affordable, 1.0)));
}

// Whole groups of lanes: on a software driver, lanes without a vertex cause validation errors as in fragment shaders
// (shaders/shared/hardware_raster.h).
std::uint32_t verticesFor(std::uint32_t points, std::uint32_t tiles) {
  constexpr std::uint64_t kLanes = 32;
  const std::uint64_t vertices = (std::uint64_t{points} * tiles * tiles + kLanes - 1) / kLanes * kLanes;
  if (vertices > std::numeric_limits<std::uint32_t>::max())
    throw UsageError("raster: {} points exceed the maximum of one draw{}", points, kInstead);
  return static_cast<std::uint32_t>(vertices);
}

}  // namespace

HardwareRaster::HardwareRaster(Device& device, const UVec2& size_px)
    : device_(checkedFor(device, size_px)),
      depthPass_(pipeline(device, shader_code::render_hardware_depth, {})),
      normalPass_(pipeline(device, shader_code::render_hardware_normals, {kSumFormat})),
      colorPass_(pipeline(device, shader_code::render_hardware_attributes, {kSumFormat, kSumFormat})),
      sums_(device, shader_code::render_hardware_sums, {.pushBytes = sizeof(shared::HardwareSumsArgs), .images = 3}),
      depth_(device, size_px, kDepthFormat, "hardware depth"),
      normals_(device, size_px, kSumFormat, "hardware normals"),
      plainReads_(device, sums_, std::array<const Attachment*, 3>{&depth_, &normals_, &normals_}) {}

void HardwareRaster::record(CommandList& list, const DrawnCloud& cloud, const RasterTarget& target,
                            const shared::RenderFrame& frame, double widest) {
  if (frame.view.isOrthographic != 0)
    throw UsageError("raster: hardware cannot draw with an orthographic camera{}", kInstead);
  const bool hasColors = frame.hasColors != 0;
  if (hasColors && !colors_) {
    colors_ = std::make_unique<Attachment>(device_, depth_.size_px(), kSumFormat, "hardware colors");
    colorReads_ = std::make_unique<ImageReads>(device_, sums_,
                                               std::array<const Attachment*, 3>{&depth_, &normals_, colors_.get()});
  }
  const int exponent = depthExponent(frame, widest);
  const auto largestPoint_px = static_cast<std::uint32_t>(device_.largestPoint_px());
  const std::uint32_t tiles = spritesOf(largestPoint_px, frame, widest);
  const std::uint32_t vertices = verticesFor(frame.count, tiles);
  shared::HardwareDiscArgs discs{
      .positions = cloud.positions().address(),
      .normals = cloud.normals().address(),
      .colors = cloud.colors().address(),
      .clips = cloud.shapes().clips.address(),
      .center_px = frame.view.center_px,
      .focal_px = frame.view.focal_px,
      .nearDepth = frame.view.nearDepth,
      .depthScale = std::ldexp(1.0f, -exponent),
      .lead = 0,
      .leastWeight = std::min(static_cast<float>(shared::kMinWeight) / shared::kFinestSum, shared::kRimWeight),
      .count = frame.count,
      .largestPoint_px = largestPoint_px,
      .tiles = tiles};
  list.draw(depthPass_, {.colors = {}, .depth = &depth_, .clearDepth = true}, vertices, discs);
  discs.lead = shared::kDepthBand;
  DrawTargets sums{.colors = {&normals_}, .depth = &depth_, .clearColors = true};
  if (hasColors) sums.colors.push_back(colors_.get());
  list.draw(hasColors ? colorPass_ : normalPass_, sums, vertices, discs);
  list.dispatch(sums_, std::uint64_t{depth_.size_px().x} * depth_.size_px().y,
                shared::HardwareSumsArgs{.depth = target.depth,
                                         .normalSums = target.normalSums,
                                         .colorSums = target.colorSums,
                                         .depthUnit = std::ldexp(1.0f, exponent),
                                         .unused = 0},
                hasColors ? *colorReads_ : plainReads_);
}

}  // namespace palpate
