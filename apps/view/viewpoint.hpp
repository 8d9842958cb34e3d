// The camera of the window, and its motions.
#pragma once

#include <optional>

#include "apps/view/settings.hpp"
#include "engine/render/camera_motion.hpp"

namespace palpate {

/// Pixels are those of the window, from the top left corner.
class Viewpoint {
 public:
  const Camera& camera() const { return camera_; }

  /// Shows the whole model between the panels: from `free_px.x` to `free_px.y`, from the left. `present`: its points,
  /// if they are not as it was loaded; null: they are.
  void fit(const Model& model, const PointCloud* present, const ViewSettings& view, const DVec2& window_px,
           const DVec2& free_px);
  /// Up axis of the settings at the last fit().
  const std::optional<UpAxis>& fittedUp() const { return fittedUp_; }
  /// Moves the centre of the view to the middle of `free_px`.
  void centerIn(const DVec2& free_px, double width_px);
  void setDepthRange(const Bounds& bounds, double size) { camera_.setDepthRange(bounds, size); }

  void lookAlong(int axis, bool fromAbove, UpAxis up, const DVec3& front) {
    camera_ = alongAxis(camera_, axis, fromAbove, up, front);
  }
  void lookFrom(ModelSide side, UpAxis up, const DVec3& front) { camera_ = fromSide(camera_, side, up, front); }
  void project(bool orthographic) { camera_ = projecting(camera_, orthographic); }
  void lookAt(const DVec3& place);
  /// Rotates about the target.
  void turn(const DVec2& way_px, const DVec2& size_px);
  /// Pans, so that the target follows the cursor.
  void move(const DVec2& way_px, const DVec2& size_px);
  /// Zooms to `place` (default: the target), to `factor` times the distance.
  void zoom(const std::optional<DVec3>& place, double factor, double longestSide);
  /// As walked().
  void walk(const DVec3& way) { camera_ = walked(camera_, way); }
  /// Sets the camera, e.g. after a drag.
  void set(const Camera& camera) { camera_ = camera; }

  /// Position in space of a pixel at that depth; nothing for depth 0 (no surface).
  std::optional<DVec3> placeAt(const DVec2& place_px, double depth, const DVec2& size_px) const;
  double targetDistance() const { return glm::distance(camera_.eye, camera_.target); }

 private:
  Camera camera_;
  std::optional<UpAxis> fittedUp_;
};

}  // namespace palpate
