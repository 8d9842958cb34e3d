#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Sides from which a model is viewed: right is to the right of a viewer in front of it.
enum class ModelSide : std::uint8_t { front, back, left, right, top, bottom, isometric };
inline constexpr std::array<std::pair<std::string_view, ModelSide>, 7> kModelSides{
    {{"front", ModelSide::front},
     {"back", ModelSide::back},
     {"left", ModelSide::left},
     {"right", ModelSide::right},
     {"top", ModelSide::top},
     {"bottom", ModelSide::bottom},
     {"isometric", ModelSide::isometric}}};
/// Towards a viewer at that side, unit. `front`: unit, horizontal.
DVec3 directionTo(ModelSide side, UpAxis up, const DVec3& front);

/// Defaults of Camera::fitting() for a cloud.
struct Framing {
  std::optional<Bounds> shown;  ///< box of the points to show (coreBoundsOf()); all points if not set
  UpAxis up = UpAxis::y;
  DVec3 front = frontOf(up);      ///< unit: towards the viewer
  double margin = 0;              ///< around each point, model units: radius of its disc
  std::optional<ModelSide> side;  ///< seen straight from there; else from the front, slightly from above
  bool orthographic = false;
  bool fromAbove = false;  ///< seen from high enough above that one looks into a room
};

/// Parameters of a camera; missing ones come from Camera::fitting(). Positions in file coordinates.
struct CameraRequest {
  std::optional<DVec3> eye, target, up;
  std::optional<double> fov_deg;  ///< vertical, 1 to 170
  std::optional<double> ortho;    ///< orthographic: height of the picture, model units; 0: so that the model fills it
  std::optional<ModelSide> side;  ///< seen straight from there; isometric is orthographic

  /// From `eye=x,y,z target=x,y,z up=x,y,z fov=degrees ortho=height`, and a name of kModelSides, any of them in any
  /// order, separated by spaces. Throws UsageError.
  static CameraRequest parse(std::string_view text);
};

/// A pinhole camera, or an orthographic one. Positions are model units relative to the cloud's origin, as in
/// PointCloud::positions. Eye space: x right, y up, depth along the view direction. Pictures have pixel (0, 0) at the
/// top left.
struct Camera {
  DVec3 eye{0, 0, 1};
  DVec3 target{0};
  DVec3 up{0, 1, 0};        ///< need not be perpendicular to the view, only not along it
  double fov_deg = 45;      ///< vertical
  double height = 0;        ///< of an orthographic picture, model units, at any depth; 0: a pinhole camera
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
  /// The same from a text for CameraRequest::parse().
  static Camera parse(std::string_view text, const PointCloud& cloud, double aspect, const Framing& framing = {});

  /// Sets near and far so that the part of `bounds` in front of the eye lies between them, or in front of it if nearer
  /// than a thousandth of the size of what the picture is of; 0 counts as 1. An orthographic camera moves back until
  /// all of it is in front.
  void setDepthRange(const Bounds& bounds, double size);

  /// Unit vectors: right, up, and forward (from the eye to the target).
  struct Axes {
    DVec3 right, up, forward;
  };
  Axes axes() const;

  bool isOrthographic() const { return height > 0; }
  /// Pixels that one unit covers at depth 1; orthographic: at any depth.
  double focal_px(double height_px) const;
  /// What lengths at a depth are divided by in the picture.
  double divisorAt(double depth) const { return isOrthographic() ? 1 : depth; }
  /// Model units that a pixel covers at a depth.
  double pixelSize(double depth, double height_px) const { return divisorAt(depth) / focal_px(height_px); }
  /// Unit, from a position against the direction in which it is seen.
  DVec3 towardsViewer(const DVec3& position) const;
  /// The point at `depth` that appears at `place_px` (pixels from the top left corner).
  DVec3 unproject(const DVec2& place_px, double depth, const DVec2& size_px) const;
  /// Position of a point in the picture: x and y in pixels from the top left corner, z its depth. Nothing if it is
  /// closer than near.
  std::optional<DVec3> project(const DVec3& position, const DVec2& size_px) const;

  /// OpenGL's eye space (looking down -z) and Vulkan's clip space (y downwards, depth 0 to 1).
  Mat4 view() const;
  Mat4 projection(double aspect) const;
};

/// The camera as a text for Camera::parse(), in file coordinates. `origin`: of the cloud.
std::string textOf(const Camera& camera, const DVec3& origin);
/// The camera of such a text, with the depth range and centre of `present`. Throws UsageError.
Camera cameraOf(std::string_view text, const DVec3& origin, const Camera& present);

/// Depths of the nearest and the farthest corner of a box; negative behind the eye.
DVec2 depthRangeOf(const Camera& camera, const Bounds& bounds);

}  // namespace palpate
