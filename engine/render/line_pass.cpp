#include "engine/render/line_pass.hpp"

#include <algorithm>
#include <cmath>

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/render.h"

namespace palpate {

namespace {

constexpr std::uint32_t kLineWorkgroup = 64;

Buffer linesFor(Device& device, std::uint64_t count) {
  return Buffer::of<shared::RenderLine>(device, count, Memory::upload, "lines");
}

shared::RenderLine packed(const SpaceLine& line) {
  std::uint32_t color = static_cast<std::uint32_t>(std::lround(255 * std::clamp(line.opacity, 0.0, 1.0))) << 24;
  for (std::uint32_t k = 0; k < 3; ++k) color |= std::uint32_t{line.color[k]} << (8 * k);
  return {.from = Vec3(line.from),
          .color = color,
          .to = Vec3(line.to),
          .width_px = static_cast<float>(std::clamp(line.width_px, 0.0, double{shared::kWidestLine_px}))};
}

bool isDrawable(const SpaceLine& line) {
  constexpr double kLargest = 1e15;  // squares of it are still numbers in single precision
  for (const DVec3& end : {line.from, line.to})
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(end[k]) < kLargest)) return false;
  return true;
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

void LinePass::record(CommandList& list, std::span<const SpaceLine> lines, const LineTarget& target) {
  Buffer& buffer = lines_[recordings_++ % kInFlight];
  if (buffer.bytes() < lines.size() * sizeof(shared::RenderLine)) buffer = linesFor(device_, lines.size());
  const auto memory = buffer.mapped<shared::RenderLine>();
  std::uint32_t count = 0;
  for (const SpaceLine& line : lines)
    if (isDrawable(line)) memory[count++] = packed(line);
  const shared::LineArgs args{.frame = target.frame,
                              .lines = buffer.address(),
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
