// A static model in water or sand: a closed cloud.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/soft_lattice.hpp"
#include "shaders/shared/matter_model.h"

namespace palpate {

/// Prefix of the name of an analytic shape (makeShape()) as a scene's model.
inline constexpr std::string_view kBuiltInModel = "builtin:";
inline bool isBuiltInModel(std::string_view model) { return model.starts_with(kBuiltInModel); }

/// The field around a model (shaders/shared/matter_model.h). Immutable; queries are safe from any thread.
class MatterModel {
 public:
  /// `cloud`: points of a closed surface; scaled to fit into the scene's box for it (modelBox_mm()), upright as stored.
  /// Throws an Error that begins with "model" if it encloses nothing, or has a hole, with the hole's position and
  /// width.
  MatterModel(PointCloud cloud, const MatterScene& scene, unsigned threads = 0);

  /// Field at a position, m.
  shared::ModelAt at(const Vec3& place) const {
    const shared::ModelCell cell = shared::modelCell(field_, place);
    if (cell.isOutside) return shared::noModel();
    const Vec4* const row = nodes_.data() + shared::modelNode(field_, cell.node);
    const auto deep = std::size_t(field_.nodes.x) * std::size_t(field_.nodes.y);
    return shared::modelAt(field_, cell.part, row[0], row[field_.nodes.x], row[deep], row[deep + field_.nodes.x]);
  }
  /// Whether a position is inside the surface.
  bool holds(const Vec3& place) const { return at(place).distance < 0; }

  const shared::ModelField& field() const { return field_; }
  std::span<const Vec4> nodes() const { return nodes_; }
  /// Points of its surface, m.
  std::span<const SurfacePlace> points() const { return points_; }
  double volume_m3() const { return volume_m3_; }
  const DVec3& middle() const { return middle_; }  ///< centroid of the volume, m

 private:
  shared::ModelField field_{};
  std::vector<Vec4> nodes_;
  std::vector<SurfacePlace> points_;
  double volume_m3_ = 0;
  DVec3 middle_{0};
};

/// Removes the positions (m) inside the model from `places`. Returns their number.
std::size_t leaveOut(std::vector<Vec3>& places, const MatterModel& model);

/// The points of a built-in model, dense enough for the scene. Throws UsageError for an unknown name.
PointCloud builtInModel(const MatterScene& scene, unsigned threads = 0);

}  // namespace palpate
