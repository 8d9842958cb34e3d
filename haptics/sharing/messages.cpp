#include "haptics/sharing/messages.hpp"

#include <unistd.h>

#include <random>

#include "engine/core/checksum.hpp"

namespace palpate::sharing {

Topics::Topics(dds_entity_t participant)
    : notices(participant, palpate_sharing_Notice_desc, "palpate/notice"),
      requests(participant, palpate_sharing_Request_desc, fmt::format("palpate/{}/request", kVersion)),
      blocks(participant, palpate_sharing_Block_desc, fmt::format("palpate/{}/block", kVersion)),
      strokes(participant, palpate_sharing_Stroke_desc, fmt::format("palpate/{}/stroke", kVersion)),
      results(participant, palpate_sharing_Result_desc, fmt::format("palpate/{}/result", kVersion)),
      resumes(participant, palpate_sharing_Resume_desc, fmt::format("palpate/{}/resume", kVersion)),
      hands(participant, palpate_sharing_Hand_desc, fmt::format("palpate/{}/hand", kVersion)),
      facts(participant, palpate_sharing_Facts_desc, fmt::format("palpate/{}/facts", kVersion)),
      nears(participant, palpate_sharing_Near_desc, fmt::format("palpate/{}/near", kVersion)),
      bricks(participant, palpate_sharing_Bricks_desc, fmt::format("palpate/{}/bricks", kVersion)),
      pings(participant, palpate_sharing_Ping_desc, fmt::format("palpate/{}/ping", kVersion)),
      echoes(participant, palpate_sharing_Ping_desc, fmt::format("palpate/{}/echo", kVersion)) {}

Id freshId() {
  std::random_device device;
  Id id;
  for (std::uint8_t& byte : id) byte = static_cast<std::uint8_t>(device());
  return id;
}

std::string partitionOf(const std::uint8_t (&id)[16]) {
  std::string name;
  for (const std::uint8_t byte : id) name += fmt::format("{:02x}", byte);
  return name;
}

std::string ownHost() {
  char name[200] = {};
  if (gethostname(name, sizeof name - 1) != 0) return "an unnamed machine";
  return printable(name);
}

std::string printable(const char* text) {
  constexpr std::size_t kLongest = 200;
  std::string shown;
  if (text == nullptr) return shown;
  for (; *text != '\0' && shown.size() < kLongest; ++text) {
    const auto character = static_cast<unsigned char>(*text);
    shown += character < 0x20 || character == 0x7f ? '?' : static_cast<char>(character);
  }
  return shown;
}

State stateOf(const PointState& point) {
  State state{.id = point.id, .color = point.color};
  for (int axis = 0; axis < 3; ++axis) {
    state.position[axis] = point.position[axis];
    state.normal[axis] = point.normal[axis];
  }
  return state;
}

PointState pointOf(const State& state) {
  return {.position = Vec3(state.position[0], state.position[1], state.position[2]),
          .id = state.id,
          .normal = Vec3(state.normal[0], state.normal[1], state.normal[2]),
          .color = state.color,
          .parent = state.id & ~PointState::kGone};
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
