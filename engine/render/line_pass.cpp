#include "engine/render/line_pass.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/render.h"

namespace palpate {

namespace {

constexpr std::uint32_t kLineWorkgroup = 64;

Buffer linesFor(Device& device, std::uint64_t count) {
  return Buffer::of<shared::RenderLine>(device, count, Memory::upload, "lines");
}

bool isDrawable(const SpaceLine& line) {
  constexpr double kLargest = 1e30;  // differences and products stay finite
  for (const DVec3& end : {line.from, line.to})
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(end[k]) < kLargest)) return false;
  return true;
}

/// The planes that bound the visible space, in eye space; those at the sides by x, y and the divisor. Visible positions
/// have no negative distance from any plane.
class SeenSpace {
 public:
  SeenSpace(const Camera& camera, const UVec2& size_px) : axes_(camera.axes()), camera_(camera) {
    const double beside_px = shared::kWidestLine_px;  // margin for the width of lines beside the picture
    const double focal_px = camera.focal_px(size_px.y);
    const DVec2 size(size_px), middle_px = camera.center * size;
    sides_ = {DVec3(focal_px, 0, middle_px.x + beside_px), DVec3(-focal_px, 0, size.x - middle_px.x + beside_px),
              DVec3(0, -focal_px, middle_px.y + beside_px), DVec3(0, focal_px, size.y - middle_px.y + beside_px)};
  }

  /// Both ends of the visible part, in eye space.
  std::optional<std::array<DVec3, 2>> partOf(const SpaceLine& line) const {
    const DVec3 from = inEye(line.from), to = inEye(line.to);
    DVec2 part(0, 1);
    cut(from.z - camera_.nearDepth, to.z - camera_.nearDepth, part);
    for (const DVec3& side : sides_) cut(glm::dot(side, divided(from)), glm::dot(side, divided(to)), part);
    if (!(part.x <= part.y)) return std::nullopt;
    return std::array{from + part.x * (to - from), from + part.y * (to - from)};
  }

 private:
  DVec3 inEye(const DVec3& place) const {
    const DVec3 way = place - camera_.eye;
    return {glm::dot(axes_.right, way), glm::dot(axes_.up, way), glm::dot(axes_.forward, way)};
  }
  DVec3 divided(const DVec3& inEye) const { return {inEye.x, inEye.y, camera_.divisorAt(inEye.z)}; }
  /// Cuts off the part behind a plane, given the distances of both ends from it.
  static void cut(double from, double to, DVec2& part) {
    if (from < 0 && to < 0) part = {1, 0};
    if (from < 0 && to >= 0) part.x = std::max(part.x, from / (from - to));
    if (from >= 0 && to < 0) part.y = std::min(part.y, from / (from - to));
  }

  Camera::Axes axes_;
  Camera camera_;
  std::array<DVec3, 4> sides_{};
};

shared::RenderLine packed(const SpaceLine& line, const std::array<DVec3, 2>& ends) {
  std::uint32_t color = static_cast<std::uint32_t>(std::lround(255 * std::clamp(line.opacity, 0.0, 1.0))) << 24;
  for (std::uint32_t k = 0; k < 3; ++k) color |= std::uint32_t{line.color[k]} << (8 * k);
  return {.from = Vec3(ends[0]),
          .color = color,
          .to = Vec3(ends[1]),
          .width_px = static_cast<float>(std::clamp(line.width_px, 0.0, double{shared::kWidestLine_px}))};
}

}  // namespace

LinePass::LinePass(Device& device, std::uint64_t pixels)
    : device_(device),
      pixels_(pixels),
      mark_(device, shader_code::render_mark_lines,
            {.workgroupSize = kLineWorkgroup, .pushBytes = sizeof(shared::LineArgs)}),
      blend_(device, shader_code::render_blend_lines, {.pushBytes = sizeof(shared::LineArgs)}),
      marks_(Buffer::of<std::uint32_t>(device, pixels, Memory::device, "marks of lines")),
      lines_{linesFor(device, 0), linesFor(device, 0), linesFor(device, 0)} {}

void LinePass::record(CommandList& list, std::span<const SpaceLine> lines, const Camera& camera, const UVec2& size_px,
                      const LineTarget& target) {
  Buffer& buffer = lines_[recordings_++ % kInFlight];
  // One more than needed: the validation layer of Debian 12 takes the load of a whole struct for larger than it is.
  if (buffer.bytes() < (lines.size() + 1) * sizeof(shared::RenderLine)) buffer = linesFor(device_, lines.size() + 1);
  const auto memory = buffer.mapped<shared::RenderLine>();
  const SeenSpace seen(camera, size_px);
  std::uint32_t count = 0;
  for (const SpaceLine& line : lines) {
    if (!isDrawable(line)) continue;
    if (const auto ends = seen.partOf(line)) memory[count++] = packed(line, *ends);
  }
  const shared::LineArgs args{.lines = buffer.address(),
                              .marks = marks_.address(),
                              .depthImage = target.depthImage,
                              .image = target.image,
                              .count = count,
                              .unused = 0};
  const auto section = list.section("lines");
  list.fill(marks_, 0, marks_.bytes());
  list.dispatch(mark_, std::uint64_t{count} * shared::kLineWalkers, args);
  list.dispatch(blend_, pixels_, args);
}

}  // namespace palpate
