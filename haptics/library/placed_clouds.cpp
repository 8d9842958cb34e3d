// The C interface: several clouds in the space of one session.
#include <algorithm>

#include "engine/core/tool_shape.hpp"
#include "haptics/library/held_session.hpp"

using namespace palpate;
using namespace palpate::library;

namespace {

PlacedCloud placedFrom(const pp_placed_cloud& given, const PointCloud& cloud, std::uint64_t index) {
  const auto& [w, x, y, z] = given.orientation;
  PlacedCloud placed{.cloud = &cloud,
                     .placement = {.offset = {given.position[0], given.position[1], given.position[2]}}};
  if (w != 0 || x != 0 || y != 0 || z != 0) placed.placement.rotation = {w, x, y, z};
  if (!isFinite(placed.placement.offset))
    throw UsageError("clouds: {}: its position {}, {}, {} is not finite", index, given.position[0], given.position[1],
                     given.position[2]);
  if (!isTurn(placed.placement.rotation))
    throw UsageError("clouds: {}: its orientation {}, {}, {}, {} is not a unit quaternion", index, w, x, y, z);
  return placed;
}

}  // namespace

pp_status pp_session_open_clouds(const pp_placed_cloud* clouds, uint64_t count, const pp_session_options* options,
                                 pp_session* session) {
  clear(session);
  return guarded([&] {
    if (count == 0) throw UsageError("clouds: is empty; give at least one");
    required(clouds, "clouds");
    std::vector<std::shared_ptr<CloudObject>> kept;
    Subject subject;
    subject.model.file = count == 1 ? "the cloud" : "the clouds";
    for (std::uint64_t i = 0; i < count; ++i) {
      kept.push_back(objectOf<CloudObject>(clouds[i].cloud.id));
      subject.clouds.push_back(placedFrom(clouds[i], kept.back()->cloud, i));
    }
    openSession(options, session, [&] { return subject; });
  });
}
