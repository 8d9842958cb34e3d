#include "haptics/sharing/messages.hpp"

#include <unistd.h>

#include <random>

#include "engine/core/packed_state.hpp"
#include "engine/core/vec.hpp"

namespace palpate::sharing {

Topics::Topics(dds_entity_t participant)
    : notices(participant, palpate_sharing_Notice_desc, "palpate/notice"),
      facts(participant, palpate_sharing_Facts_desc, fmt::format("palpate/{}/facts", kVersion)),
      wants(participant, palpate_sharing_Want_desc, fmt::format("palpate/{}/want", kVersion)),
      points(participant, palpate_sharing_PointsSample_desc, fmt::format("palpate/{}/points", kVersion)),
      strokes(participant, palpate_sharing_Stroke_desc, fmt::format("palpate/{}/stroke", kVersion)),
      hands(participant, palpate_sharing_Hand_desc, fmt::format("palpate/{}/hand", kVersion)),
      cameras(participant, palpate_sharing_Camera_desc, fmt::format("palpate/{}/camera", kVersion)),
      pings(participant, palpate_sharing_Ping_desc, fmt::format("palpate/{}/ping", kVersion)) {}

Topic<Facts> factsOf(dds_entity_t participant, const Id& session) {
  Topic<Facts> facts(participant, palpate_sharing_Facts_desc, fmt::format("palpate/{}/facts", kVersion));
  facts.letThrough(
      [](const void* sample, void* of) {
        return isSame(static_cast<const Facts*>(sample)->session, *static_cast<const Id*>(of));
      },
      &session);
  return facts;
}

Id freshId() {
  std::random_device device;
  Id id;
  for (std::uint8_t& byte : id) byte = static_cast<std::uint8_t>(device());
  return id;
}

std::string partitionOf(const Id& id) {
  std::string name;
  for (const std::uint8_t byte : id) name += fmt::format("{:02x}", byte);
  return name;
}

std::string ownHost() {
  char name[200] = {};
  if (gethostname(name, sizeof name - 1) != 0) return "an unnamed machine";
  return printable(name);
}

namespace {

// Bytes of the UTF-8 character at `text`; 0 if it is invalid or a control character for a terminal.
std::size_t characterAt(const char* text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = at(0);
  if (first < 0x80) return first < 0x20 || first == 0x7f ? 0 : 1;
  const std::size_t size = first >= 0xc2 && first <= 0xdf   ? 2
                           : first >= 0xe0 && first <= 0xef ? 3
                           : first >= 0xf0 && first <= 0xf4 ? 4
                                                            : 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((at(i) & 0xc0) != 0x80) return 0;
  const bool isCommand = first == 0xc2 && at(1) < 0xa0;
  const bool isTooLong = (first == 0xe0 && at(1) < 0xa0) || (first == 0xf0 && at(1) < 0x90);
  const bool isNone = (first == 0xed && at(1) >= 0xa0) || (first == 0xf4 && at(1) >= 0x90);
  return isCommand || isTooLong || isNone ? 0 : size;
}

}  // namespace

std::string printable(const char* text) {
  constexpr std::size_t kLongest = 200;
  std::string shown;
  if (text == nullptr) return shown;
  while (*text != '\0') {
    const std::size_t size = characterAt(text);
    if (shown.size() + std::max<std::size_t>(size, 1) > kLongest) break;
    shown += size == 0 ? "?" : std::string(text, size);
    text += std::max<std::size_t>(size, 1);
  }
  return shown;
}

bool isValid(const Point& point) {
  constexpr float kLongest = 1.01F;  // maximum length of a unit normal
  return isFinite(Vec3(point.position[0], point.position[1], point.position[2])) &&
         glm::length(Vec3(point.normal[0], point.normal[1], point.normal[2])) < kLongest;
}

State stateOf(const PointState& point) {
  State state{.id = packedState(point).id, .color = point.color};
  for (int axis = 0; axis < 3; ++axis) {
    state.position[axis] = point.position[axis];
    state.normal[axis] = point.normal[axis];
  }
  return state;
}

PointState pointOf(const State& state) {
  return palpate::stateOf({.position = Vec3(state.position[0], state.position[1], state.position[2]),
                           .id = state.id,
                           .normal = Vec3(state.normal[0], state.normal[1], state.normal[2]),
                           .color = state.color,
                           .parent = state.id & ~PackedState::kGone});
}

std::uint64_t checksumOf(const PointCloud& cloud) {
  Checksum sum;
  for (int axis = 0; axis < 3; ++axis) sum.addValue(cloud.origin[axis]);
  sum.addValue(std::uint64_t{cloud.size()});
  sum.add(std::as_bytes(std::span(cloud.positions)));
  sum.add(std::as_bytes(std::span(cloud.normals)));
  sum.add(std::as_bytes(std::span(cloud.colors)));
  return sum.value();
}

}  // namespace palpate::sharing
