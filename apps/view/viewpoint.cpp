#include "apps/view/viewpoint.hpp"

#include <algorithm>

#include "engine/render/camera_motion.hpp"

#include "engine/cloud/voxel_sample.hpp"

namespace palpate {

void Viewpoint::fit(const Model& model, const PointCloud* present, const ViewSettings& view, const DVec2& window_px,
                    const DVec2& free_px) {
  constexpr double kHeight_deg = 45;
  fittedUp_ = view.up;
  const UpAxis up = view.upOf(model);
  const double aspect = (free_px.y - free_px.x) / window_px.y;
  constexpr double kHand = 0.08;  // of the longest side: room for a stylus around the model
  Framing framing = framingOf(model, up);
  framing.front = view.frontFor(model);
  if (present && framing.shown) framing.shown = coreBoundsOf(*present);
  if (!model.container()) framing.margin = std::max(framing.margin, kHand * model.shownBounds().longestSide());
  // Its points fill the view, and not the box around them; a container is shown whole.
  camera_ = model.container() ? Camera::fitting(model.shownBounds(), aspect, kHeight_deg, up, framing.margin)
                              : Camera::fitting(present ? *present : model.cloud, aspect, kHeight_deg, framing);
  centerIn(free_px, window_px.x);
}

void Viewpoint::centerIn(const DVec2& free_px, double width_px) {
  camera_.center.x = 0.5 * (free_px.x + free_px.y) / width_px;
}

void Viewpoint::lookAt(const DVec3& place) { camera_ = recentred(camera_, place); }

void Viewpoint::turn(const DVec2& way_px, const DVec2& size_px) {
  camera_ = orbited(camera_, camera_.target, way_px, size_px);
}

void Viewpoint::move(const DVec2& way_px, const DVec2& size_px) {
  camera_ = panned(camera_, targetDistance(), way_px, size_px);
}

void Viewpoint::zoom(const std::optional<DVec3>& place, double factor, double longestSide) {
  constexpr double kNearest = 1e-3, kFarthest = 50;  // longest sides
  camera_ = zoomed(camera_, place.value_or(camera_.target), factor, kNearest * longestSide, kFarthest * longestSide);
}

std::optional<DVec3> Viewpoint::placeAt(const DVec2& place_px, double depth, const DVec2& size_px) const {
  if (!(depth > 0)) return std::nullopt;
  return camera_.unproject(place_px, depth, size_px);
}

}  // namespace palpate
