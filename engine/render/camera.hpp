#pragma once

#include <optional>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Defaults of Camera::fitting() for a cloud.
struct Framing {
  std::optional<Bounds> shown;  ///< box of the points to show (coreBoundsOf()); all points if not set
  UpAxis up = UpAxis::y;
  DVec3 front = frontOf(up);  ///< unit: towards the viewer
  double margin = 0;          ///< around each point, model units: radius of its disc
};

/// Parameters of a camera; missing ones come from Camera::fitting(). Positions in file coordinates.
struct CameraRequest {
  std::optional<DVec3> eye, target, up;
  std::optional<double> fov_deg;  ///< vertical, 1 to 170
};

/// A pinhole camera. Positions are model units relative to the cloud's origin, as in PointCloud::positions.
/// Eye space: x right, y up, depth along the view direction. Pictures have pixel (0, 0) at the top left.
struct Camera {
  DVec3 eye{0, 0, 1};
  DVec3 target{0};
  DVec3 up{0, 1, 0};        ///< need not be perpendicular to the view, only not along it
  double fov_deg = 45;      ///< vertical
  double nearDepth = 0.01;  ///< closer points are not drawn
  double farDepth = 100;    ///< for projection() only
  DVec2 center{0.5};        ///< position of the target: shares of the picture's width and height, from the top left

  bool operator==(const Camera&) const = default;

  /// Views everything from the front, slightly from above, and from higher above if the model is flat, in a
  /// picture of aspect ratio `aspect` (width / height): a whole box, or all points of a cloud, which fills the picture
  /// better. The target is at the depth of the box's centre.
  static Camera fitting(const Bounds& bounds, double aspect, double fov_deg = 45, UpAxis up = UpAxis::y,
                        double margin = 0);
  static Camera fitting(const PointCloud& cloud, double aspect, double fov_deg = 45, const Framing& framing = {});

  /// A camera as requested. Throws UsageError for invalid parameters.
  static Camera asked(const CameraRequest& request, const PointCloud& cloud, double aspect,
                      const Framing& framing = {});
  /// The same from `eye=x,y,z target=x,y,z up=x,y,z fov=degrees`, any of them in any order, separated by spaces.
  static Camera parse(std::string_view text, const PointCloud& cloud, double aspect, const Framing& framing = {});

  /// Sets near and far so that the part of `bounds` in front of the eye lies between them, or in front of it if nearer
  /// than a thousandth of the size of what the picture is of; 0 counts as 1.
  void setDepthRange(const Bounds& bounds, double size);

  /// Unit vectors: right, up, and forward (from the eye to the target).
  struct Axes {
    DVec3 right, up, forward;
  };
  Axes axes() const;

  /// Pixels that one unit covers at depth 1.
  double focal_px(double height_px) const;
  /// The point at `depth` that appears at `place_px` (pixels from the top left corner).
  DVec3 unproject(const DVec2& place_px, double depth, const DVec2& size_px) const;
  /// Position of a point in the picture: x and y in pixels from the top left corner, z its depth. Nothing if it is
  /// closer than near.
  std::optional<DVec3> project(const DVec3& position, const DVec2& size_px) const;

  /// OpenGL's eye space (looking down -z) and Vulkan's clip space (y downwards, depth 0 to 1).
  Mat4 view() const;
  Mat4 projection(double aspect) const;
};

/// Depths of the nearest and the farthest corner of a box; negative behind the eye.
DVec2 depthRangeOf(const Camera& camera, const Bounds& bounds);

}  // namespace palpate
