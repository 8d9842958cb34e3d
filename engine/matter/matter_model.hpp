// A closed cloud that stands still in water or sand.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/matter/matter_scene.hpp"
#include "engine/matter/soft_lattice.hpp"
#include "shaders/shared/matter_model.h"

namespace palpate {

/// What stands before the name of an analytic shape (makeShape()) that is a scene's model.
inline constexpr std::string_view kBuiltInModel = "builtin:";
inline bool isBuiltInModel(std::string_view model) { return model.starts_with(kBuiltInModel); }

/// A field about a model (shaders/shared/matter_model.h). Never changes; queries are safe from any thread.
class MatterModel {
 public:
  /// `cloud`: of a closed surface, as large as fits into the scene's box for it (modelBox_mm()) and upright as it is
  /// stored. Throws Error that begins with "model" for one that encloses nothing, or has a hole, of which it says where
  /// it is and how wide.
  MatterModel(PointCloud cloud, const MatterScene& scene, unsigned threads = 0);

  /// About a place, m.
  shared::ModelAt at(const Vec3& place) const {
    const shared::ModelCell cell = shared::modelCell(field_, place);
    if (cell.isOutside) return shared::noModel();
    const Vec4* const row = nodes_.data() + shared::modelNode(field_, cell.node);
    const auto deep = std::size_t(field_.nodes.x) * std::size_t(field_.nodes.y);
    return shared::modelAt(field_, cell.part, row[0], row[field_.nodes.x], row[deep], row[deep + field_.nodes.x]);
  }
  /// Whether a place is within the surface.
  bool holds(const Vec3& place) const { return at(place).distance < 0; }

  const shared::ModelField& field() const { return field_; }
  std::span<const Vec4> nodes() const { return nodes_; }
  /// Of its surface, m.
  std::span<const SurfacePlace> points() const { return points_; }
  double volume_m3() const { return volume_m3_; }
  const DVec3& middle() const { return middle_; }  ///< of the volume, m

 private:
  shared::ModelField field_{};
  std::vector<Vec4> nodes_;
  std::vector<SurfacePlace> points_;
  double volume_m3_ = 0;
  DVec3 middle_{0};
};

/// Takes what would begin in the model out of `places` (m). How many that are.
std::size_t leaveOut(std::vector<Vec3>& places, const MatterModel& model);

/// The points of a built-in model, dense enough for the scene. Throws UsageError for a name that there is not.
PointCloud builtInModel(const MatterScene& scene, unsigned threads = 0);

}  // namespace palpate
