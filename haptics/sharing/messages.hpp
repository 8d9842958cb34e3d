// The topics of this version and the types of their samples.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/checksum.hpp"
#include "engine/core/point_state.hpp"
#include "haptics/sharing/dds.hpp"
#include "haptics/sharing/id.hpp"
#include "haptics/sharing/sharing.h"

namespace palpate::sharing {

using Notice = palpate_sharing_Notice;
using Point = palpate_sharing_Point;
using State = palpate_sharing_State;
using Stroke = palpate_sharing_Stroke;
using HandSample = palpate_sharing_Hand;
using Camera = palpate_sharing_Camera;
using Facts = palpate_sharing_Facts;
using Want = palpate_sharing_Want;
using BrickPart = palpate_sharing_BrickPart;
using Points = palpate_sharing_PointsSample;
using Ping = palpate_sharing_Ping;

/// Version of the network protocol; raised with each change of a type.
inline constexpr std::uint32_t kVersion = 9;
/// Points of a block, which fits into one Ethernet frame: DDS resends one fragment of a split sample per round trip,
/// but all lost whole samples at once.
inline constexpr std::uint32_t kBlockPoints = 43;
/// States of a stroke, or edits of others, which fit into one Ethernet frame, too.
inline constexpr std::uint32_t kStates = 36;

/// The `total` in a brick's head that says that the brick is no longer updated.
inline constexpr std::uint32_t kBrickDropped = 0xffffffff;

/// All topics of a session.
struct Topics {
  explicit Topics(dds_entity_t participant);
  Topic<Notice> notices;
  Topic<Facts> facts;
  Topic<Want> wants;
  Topic<Points> points;
  Topic<Stroke> strokes;
  Topic<HandSample> hands;
  Topic<Camera> cameras;
  Topic<Ping> pings;
};

/// Facts of that session only, however many others are announced. The id must outlive the readers of this topic.
Topic<Facts> factsOf(dds_entity_t participant, const Id& session);

/// A unique id.
Id freshId();
/// Partition of the echoes of pings.
inline constexpr const char* kEchoes = "echoes";
/// Partition of the client with that id.
std::string partitionOf(const Id& id);
inline void set(std::uint8_t (&to)[16], const Id& id) { std::memcpy(to, id.data(), id.size()); }
inline bool isSame(const std::uint8_t (&a)[16], const Id& b) { return std::memcmp(a, b.data(), b.size()) == 0; }
inline Id idOf(const std::uint8_t (&id)[16]) { return std::to_array(id); }

/// Host name of this machine.
std::string ownHost();

/// Copies the text, truncated to the room.
template <std::size_t room>
void put(char (&to)[room], std::string_view text) {
  const std::size_t length = std::min(text.size(), room - 1);
  std::memcpy(to, text.data(), length);
  to[length] = '\0';
}

/// Up to 200 bytes of UTF-8 that a terminal shows unchanged: foreign text is used in messages, tables and JSON.
std::string printable(const char* text);

inline std::uint64_t blocksOf(std::uint64_t points) { return (points + kBlockPoints - 1) / kBlockPoints; }
inline std::uint32_t pointsIn(std::uint64_t block, std::uint64_t points) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(kBlockPoints, points - block * kBlockPoints));
}

State stateOf(const PointState& point);
PointState pointOf(const State& state);

/// Checksum of the origin and of all data of the points that is sent.
std::uint64_t checksumOf(const PointCloud& cloud);
/// Checksum of a block of points.
inline std::uint64_t checksumOf(std::span<const Point> block) {
  Checksum sum;
  sum.add(std::as_bytes(block));
  return sum.value();
}
/// Whether a server can have sent it.
bool isValid(const Point& point);

}  // namespace palpate::sharing
