// The objects behind handles, and the conversion of one to the other.
#pragma once

#include <palpate/palpate.h>

#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/mesh/mesh.hpp"
#include "haptics/library/handles.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate::library {

class OpenMatter;
class OpenServer;
struct LogObject;

/// View of the points in memory.
pp_points viewOf(const PointCloud& cloud);

/// Immutable.
struct CloudObject {
  explicit CloudObject(PointCloud points, ModelConfig from = {.file = "the cloud"})
      : cloud(std::move(points)), source(std::move(from)), view(viewOf(cloud)) {}
  PointCloud cloud;
  ModelConfig source;  ///< file that it was read from, and the options of reading, for the header of a session log
  pp_points view;
};

struct MeshObject {
  Mesh mesh;
  double cell = 0;  ///< size of a cell of the lattice, model units
  pp_triangles view{};
};

/// Moving points at one time.
struct FrameObject {
  PointCloud cloud;
  std::vector<Vec3> velocities;  ///< one for each point, model units per second
  double time_s = 0;
  std::uint64_t moving = 0;  ///< number of moving points, which come first
};

template <class Object>
constexpr HandleKind kKindOf = std::is_same_v<Object, CloudObject>   ? HandleKind::cloud
                               : std::is_same_v<Object, MeshObject>  ? HandleKind::mesh
                               : std::is_same_v<Object, FrameObject> ? HandleKind::frame
                               : std::is_same_v<Object, OpenMatter>  ? HandleKind::matter
                               : std::is_same_v<Object, OpenServer>  ? HandleKind::server
                               : std::is_same_v<Object, LogObject>   ? HandleKind::log
                                                                     : HandleKind::session;

/// Throws HandleError.
template <class Object>
std::shared_ptr<Object> objectOf(std::uint64_t handle) {
  return std::static_pointer_cast<Object>(handles().find(kKindOf<Object>, handle));
}

template <class Handle, class Object>
Handle opened(std::shared_ptr<Object> object) {
  return {handles().add(kKindOf<Object>, std::move(object))};
}

}  // namespace palpate::library
