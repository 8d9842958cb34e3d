#include "engine/touch/host_frames.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "shaders/shared/spatial_hash.h"

namespace palpate {

HostFrames::HostFrames(Device& device, CloudSource& source)
    : source_(source),
      positions_(Buffer::of<Vec4>(device, source.size(), Memory::upload, "staged positions")),
      normals_(Buffer::of<Vec4>(device, source.size(), Memory::upload, "staged normals")),
      velocities_(Buffer::of<Vec4>(device, (source.turnsNormals() ? 2 : 1) * source.size(), Memory::upload,
                                   "staged velocities")) {}

MadeFrame HostFrames::make(double time_s, const LiveCloud::Half& /*incoming*/) {
  if (made_s_ && (*made_s_ == time_s || !source_.hasNewer(time_s, frame_.time_s))) return MadeFrame::none;
  made_s_ = time_s;
  source_.makeFrame(time_s, frame_);
  requireWhole(frame_, source_.size());
  stage();
  return MadeFrame::recorded;
}

void HostFrames::stage() {
  const std::span<Vec4> positions = positions_.mapped<Vec4>(), normals = normals_.mapped<Vec4>();
  const std::span<Vec4> velocities = velocities_.mapped<Vec4>();
  for (std::size_t i = 0; i < frame_.size(); ++i) {
    const std::uint32_t id = frame_.idOf(i);
    const auto [red, green, blue] = frame_.colors.empty() ? std::array<std::uint8_t, 3>{} : frame_.colors[i];
    positions[i] = Vec4(frame_.positions[i], std::bit_cast<float>(id));
    normals[i] = Vec4(frame_.normals[i], std::bit_cast<float>(bitsOfColor(red, green, blue)));
    velocities[id] = frame_.velocities.empty() ? Vec4(0) : Vec4(frame_.velocities[i], frame_.slides ? 0.0f : 1.0f);
    if (turnsNormals()) velocities[size() + id] = frame_.turns.empty() ? Vec4(0) : Vec4(frame_.turns[i], 0.0f);
  }
  std::ranges::fill(positions.subspan(frame_.size()), Vec4(0, 0, 0, std::bit_cast<float>(shared::kEmptySlot)));
}

void HostFrames::record(CommandList& list, const Front& /*front*/, const LiveCloud::Half& incoming,
                        const Buffer& velocities) const {
  const auto overlap = list.independent();
  list.copy(positions_, incoming.positions, positions_.bytes());
  list.copy(normals_, incoming.normals, normals_.bytes());
  list.copy(velocities_, velocities, velocities_.bytes());
}

}  // namespace palpate
