#include "engine/select/screen_select.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {

namespace {

/// Camera::project() for many points.
class Projection {
 public:
  Projection(const Camera& camera, const DVec2& size_px)
      : camera_(camera),
        axes_(camera.axes()),
        middle_px_(camera.center * size_px),
        focal_px_(camera.focal_px(size_px.y)) {}

  /// Pixels, and depth; a depth below that of the nearest point that is drawn: it is not in the picture.
  DVec3 operator()(const Vec3& position) const {
    const DVec3 p = DVec3(position) - camera_.eye;
    const double depth = glm::dot(p, axes_.forward), scale = focal_px_ / camera_.divisorAt(depth);
    return {middle_px_.x + scale * glm::dot(p, axes_.right), middle_px_.y - scale * glm::dot(p, axes_.up), depth};
  }
  bool shows(const DVec3& projected) const { return projected.z >= camera_.nearDepth; }

 private:
  Camera camera_;
  Camera::Axes axes_;
  DVec2 middle_px_;
  double focal_px_;
};

}  // namespace

PointBits pointsInOutline(std::span<const PointState> points, const PointBits& among, const ScreenOutline& outline,
                          const Camera& camera, const DVec2& size_px, unsigned threads) {
  const Projection project(camera, size_px);
  return PointBits::where(points.size(), threads, [&](std::size_t i) {
    if (!among.test(i)) return false;
    const DVec3 at = project(points[i].position);
    return project.shows(at) && outline.contains(DVec2(at));
  });
}

PointBits firstSurface(std::span<const PointState> points, const PointBits& among, const DepthPicture& picture,
                       double tolerance, unsigned threads) {
  constexpr double kGrazing = 0.5;     // cosine of the normal to the eye below which both sides of a rim may be meant
  constexpr std::size_t kNearly = 10;  // to one
  constexpr double kBeside_px = 0.75;  // from the middle of a pixel
  constexpr double kSteepest = 30, kUnknown = 4;  // depth for each unit aside; of a point without a normal
  const Projection project(picture.camera, picture.size_px);
  const double aside = kBeside_px * picture.shrink / picture.camera.focal_px(picture.size_px.y);  // at depth 1
  // Seen points whose normals face the eye, face away, and which of both at a grazing angle.
  enum Facing : std::size_t { eye, away, grazingEye, grazingAway };
  std::array<PointBits, 4> facing;
  facing.fill(PointBits(points.size()));
  PointBits seen = PointBits::where(points.size(), threads, [&](std::size_t i) {
    if (!among.test(i)) return false;
    const DVec3 at = project(points[i].position);
    const bool isInPicture = at.x >= 0 && at.y >= 0 && at.x < picture.size_px.x && at.y < picture.size_px.y;
    if (!project.shows(at) || !isInPicture) return false;
    const DVec3 toEye = picture.camera.towardsViewer(DVec3(points[i].position));
    const double cosine = glm::dot(DVec3(points[i].normal), toEye), across = std::abs(cosine);
    const bool isKnown = points[i].normal != Vec3(0);
    const double slope =
        isKnown ? std::min(kSteepest, std::sqrt(std::max(0.0, 1 - across * across)) / across) : kUnknown;
    const double front = picture.depthAt(DVec2(at));
    if (front > 0 && !(at.z <= front + tolerance + aside * picture.camera.divisorAt(at.z) * slope)) return false;
    const bool isGrazing = across < kGrazing;
    if (cosine > 0) facing[isGrazing ? grazingEye : eye].set(i);
    if (cosine < 0) facing[isGrazing ? grazingAway : away].set(i);
    return true;
  });
  const std::size_t towards = facing[eye].count(), from = facing[away].count();
  if (towards > kNearly * from) seen -= facing[grazingAway];
  if (from > kNearly * towards) seen -= facing[grazingEye];
  return seen;
}

}  // namespace palpate
