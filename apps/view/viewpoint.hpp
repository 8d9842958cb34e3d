// From where a person looks at the model.
#pragma once

#include <optional>

#include "apps/view/settings.hpp"
#include "engine/render/camera_motion.hpp"

namespace palpate {

/// Pixels are those of the window, from the top left corner.
class Viewpoint {
 public:
  const Camera& camera() const { return camera_; }

  /// All of the model is seen where the panels leave room: from `free_px.x` to `free_px.y`, from the left.
  void fit(const Model& model, const ViewSettings& view, const DVec2& window_px, const DVec2& free_px);
  /// Which way is up as the settings had it when that was done last.
  const std::optional<UpAxis>& fittedUp() const { return fittedUp_; }
  /// The middle of what is seen stands in the middle of that.
  void centerIn(const DVec2& free_px, double width_px);
  void setDepthRange(const Bounds& bounds) { camera_.setDepthRange(bounds); }

  void lookAlong(int axis, bool fromAbove, UpAxis up);
  void lookFrom(ModelSide side, UpAxis up) { camera_ = fromSide(camera_, side, up); }
  void lookAt(const DVec3& place);
  /// About the target.
  void turn(const DVec2& way_px, const DVec2& size_px);
  /// Along with the target.
  void move(const DVec2& way_px, const DVec2& size_px);
  /// To `place` (the target, if there is none) until `factor` times the distance is left.
  void zoom(const std::optional<DVec3>& place, double factor, double longestSide);
  /// As a drag takes it.
  void set(const Camera& camera) { camera_ = camera; }

  /// The place in the picture's depth, if it has any there.
  std::optional<DVec3> placeAt(const DVec2& place_px, double depth, const DVec2& size_px) const;
  double targetDistance() const { return glm::distance(camera_.eye, camera_.target); }

 private:
  Camera camera_;
  std::optional<UpAxis> fittedUp_;
};

}  // namespace palpate
