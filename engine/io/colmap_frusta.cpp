#include "engine/io/colmap_frusta.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

namespace {

/// Pinhole intrinsics, pixels. The upper left corner of the picture is at (0, 0).
struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
};

/// Models with one focal length store it first, then the principal point; models with two store both first.
std::optional<Intrinsics> intrinsicsOf(const ColmapCamera& camera) {
  if (camera.model == "unknown" || camera.model == "EQUIRECTANGULAR") return std::nullopt;  // no focal length first
  const std::vector<double>& p = camera.parameters;
  const bool hasOneFocalLength = camera.model.starts_with("SIMPLE_") || camera.model.starts_with("RADIAL");
  if (p.size() < (hasOneFocalLength ? 3u : 4u) || camera.width == 0 || camera.height == 0) return std::nullopt;
  const Intrinsics found = hasOneFocalLength ? Intrinsics{p[0], p[0], p[1], p[2]} : Intrinsics{p[0], p[1], p[2], p[3]};
  constexpr double kShortest = 1e-3;  // of the picture's side
  const bool isLens = found.fx > kShortest * static_cast<double>(camera.width) &&
                      found.fy > kShortest * static_cast<double>(camera.height);
  return isLens ? std::optional(found) : std::nullopt;
}

/// Intersection of a pixel's ray with the plane one unit in front of the camera: right, and down.
DVec2 onPlane(const ColmapCamera& camera, const Intrinsics& k, double column, double row) {
  constexpr double kWidest = 1.3;  // rad
  const DVec2 place((column - k.cx) / k.fx, (row - k.cy) / k.fy);
  const double off = glm::length(place);
  if (!camera.model.ends_with("FISHEYE") || !(off > 0)) return place;
  return std::tan(std::min(off, kWidest)) / off * place;
}

}  // namespace

std::vector<CameraFrustum> frustaOf(const ColmapModel& model) {
  std::vector<CameraFrustum> frusta;
  for (const ColmapImage& image : model.images) {
    if (image.camera == kNoCamera) continue;
    const ColmapCamera& camera = model.cameras[image.camera];
    const auto intrinsics = intrinsicsOf(camera);
    if (!intrinsics) continue;
    const auto width = static_cast<double>(camera.width), height = static_cast<double>(camera.height);
    const auto corner = [&](double column, double row) {
      const DVec2 place = onPlane(camera, *intrinsics, column, row);
      return place.x * image.right + place.y * image.down + image.forward;
    };
    frusta.push_back({.centre = image.center,
                      .corners = {corner(0, 0), corner(width, 0), corner(width, height), corner(0, height)}});
  }
  return frusta;
}

std::optional<UpAxis> upOf(const ColmapModel& model) {
  DVec3 up(0);
  for (const ColmapImage& image : model.images) up -= image.down;
  return upOfCameras(up / std::max(1.0, static_cast<double>(model.images.size())));
}

}  // namespace palpate
