// What handles stand for, and the way from one to the other.
#pragma once

#include <palpate/palpate.h>

#include <memory>
#include <type_traits>

#include "engine/cloud/point_cloud.hpp"
#include "engine/mesh/mesh.hpp"
#include "haptics/library/handles.hpp"

namespace palpate::library {

class OpenSession;

/// Where the points lie in memory.
pp_points viewOf(const PointCloud& cloud);

/// Never changed once it is made.
struct CloudObject {
  explicit CloudObject(PointCloud points) : cloud(std::move(points)), view(viewOf(cloud)) {}
  PointCloud cloud;
  pp_points view;
};

struct MeshObject {
  Mesh mesh;
  double cell = 0;  ///< of the lattice, model units
  pp_triangles view{};
};

template <class Object>
constexpr HandleKind kKindOf = std::is_same_v<Object, CloudObject>  ? HandleKind::cloud
                               : std::is_same_v<Object, MeshObject> ? HandleKind::mesh
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
