// The topics of this version, and what is in their samples.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/point_state.hpp"
#include "haptics/sharing/dds.hpp"
#include "haptics/sharing/id.hpp"
#include "haptics/sharing/sharing.h"

namespace palpate::sharing {

using Notice = palpate_sharing_Notice;
using Request = palpate_sharing_Request;
using Point = palpate_sharing_Point;
using Block = palpate_sharing_Block;
using State = palpate_sharing_State;
using Stroke = palpate_sharing_Stroke;
using Result = palpate_sharing_Result;
using ResumeRequest = palpate_sharing_Resume;
using HandSample = palpate_sharing_Hand;
using Camera = palpate_sharing_Camera;
using Facts = palpate_sharing_Facts;
using Near = palpate_sharing_Near;
using BrickPart = palpate_sharing_BrickPart;
using Bricks = palpate_sharing_Bricks;
using Ping = palpate_sharing_Ping;

/// Of what is said on the network. Who changes a type raises it.
inline constexpr std::uint32_t kVersion = 4;
/// Points of a block, which fits into one frame of Ethernet: of samples that are cut in pieces DDS mends one in each
/// round trip, of whole ones all that are lost.
inline constexpr std::uint32_t kBlockPoints = 45;
inline constexpr std::uint32_t kMaxRequested = 4096;  // blocks at a time
/// States of a stroke or a result, which fit into one frame, too.
inline constexpr std::uint32_t kStates = 36;

/// The `total` of a brick's head that says that the brick is no longer kept up.
inline constexpr std::uint32_t kBrickDropped = 0xffffffff;

/// All that a session's sides speak by.
struct Topics {
  explicit Topics(dds_entity_t participant);
  Topic<Notice> notices;
  Topic<Request> requests;
  Topic<Block> blocks;
  Topic<Stroke> strokes;
  Topic<Result> results;
  Topic<Stroke> strokeCopies;
  Topic<Result> resultCopies;
  Topic<ResumeRequest> resumes;
  Topic<HandSample> hands;
  Topic<Camera> cameras;
  Topic<Facts> facts;
  Topic<Near> nears;
  Topic<Bricks> bricks;
  Topic<Ping> pings, echoes;
};

/// Facts of that session, however many others somebody makes up. The id outlives the readers that are made of it.
Topic<Facts> factsOf(dds_entity_t participant, const Id& session);

/// One that no other has.
Id freshId();
/// The partition of who has it.
std::string partitionOf(const std::uint8_t (&id)[16]);
inline void set(std::uint8_t (&to)[16], const Id& id) { std::memcpy(to, id.data(), id.size()); }
inline bool isSame(const std::uint8_t (&a)[16], const Id& b) { return std::memcmp(a, b.data(), b.size()) == 0; }
inline Id idOf(const std::uint8_t (&id)[16]) { return std::to_array(id); }

/// What a machine calls itself.
std::string ownHost();

/// As much of it as there is room for.
template <std::size_t room>
void put(char (&to)[room], std::string_view text) {
  const std::size_t length = std::min(text.size(), room - 1);
  std::memcpy(to, text.data(), length);
  to[length] = '\0';
}

/// Up to 200 bytes of UTF-8 that a terminal shows as they are: what others say stands in messages, tables and JSON.
std::string printable(const char* text);

inline std::uint64_t blocksOf(std::uint64_t points) { return (points + kBlockPoints - 1) / kBlockPoints; }
inline std::uint32_t pointsIn(std::uint64_t block, std::uint64_t points) {
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(kBlockPoints, points - block * kBlockPoints));
}

State stateOf(const PointState& point);
PointState pointOf(const State& state);

/// Of the origin and of all that is sent of the points.
std::uint64_t checksumOf(const PointCloud& cloud);

}  // namespace palpate::sharing
