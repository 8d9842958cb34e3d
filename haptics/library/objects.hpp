// What handles stand for, and the way from one to the other.
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

/// Where the points lie in memory.
pp_points viewOf(const PointCloud& cloud);

/// Never changed once it is made.
struct CloudObject {
  explicit CloudObject(PointCloud points, ModelConfig from = {.file = "the cloud"})
      : cloud(std::move(points)), source(std::move(from)), view(viewOf(cloud)) {}
  PointCloud cloud;
  ModelConfig source;  ///< the file that it was read from, and how, so that a session log can name it
  pp_points view;
};

struct MeshObject {
  Mesh mesh;
  double cell = 0;  ///< of the lattice, model units
  pp_triangles view{};
};

/// Points that move, as they were at a time.
struct FrameObject {
  PointCloud cloud;
  std::vector<Vec3> velocities;  ///< one for each, model units per second
  double time_s = 0;
  std::uint64_t moving = 0;  ///< the first so many move
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
