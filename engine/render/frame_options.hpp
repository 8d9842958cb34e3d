// What a frame shows and how.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/vec.hpp"
#include "shaders/shared/render.h"

namespace palpate {

/// The picture, or one of the images on the way to it.
enum class ImagePass : std::uint32_t {
  final = shared::kPassFinal,
  depth = shared::kPassDepth,              ///< near is bright
  smoothDepth = shared::kPassSmoothDepth,  ///< the same of the smoothed depth
  normal = shared::kPassNormal,            ///< 0.5 + 0.5 n, model axes, towards the eye
  color = shared::kPassColor,              ///< the surface's own colour, unlit
  position = shared::kPassPosition,        ///< 0 to 1 along each side of the model's box
};

/// Where the surface's own colour comes from.
enum class ColorBy : std::uint32_t {
  rgb = shared::kColorByFile,  ///< the file's, or one material where it has none
  normal = shared::kColorByNormal,
  depth = shared::kColorByDepth,
  height = shared::kColorByHeight,  ///< along FrameOptions::up
};

/// Who draws the discs of a cloud. The pictures are the same, but for samples on the rims of discs.
enum class Raster : std::uint32_t {
  compute,
  hardware,  ///< the graphics pipeline: point sprites
};

/// As on the command line.
inline constexpr std::array<std::pair<std::string_view, ColorBy>, 4> kColorNames{
    {{"rgb", ColorBy::rgb}, {"normal", ColorBy::normal}, {"depth", ColorBy::depth}, {"height", ColorBy::height}}};

/// By the names of the command line. Throw UsageError with the names there are.
ImagePass imagePassNamed(std::string_view name);
ColorBy colorByNamed(std::string_view name);
Raster rasterNamed(std::string_view name);

/// Drawn over the surface; what lies behind it shines through. Model units relative to the cloud's origin.
struct Overlays {
  struct Ball {
    DVec3 center{0};
    double radius = 0;
    bool operator==(const Ball&) const = default;
  };
  struct Disc {
    DVec3 center{0};
    DVec3 normal{0, 1, 0};  ///< unit
    double radius = 0;
    bool operator==(const Disc&) const = default;
  };
  struct Arrow {
    DVec3 from{0};
    DVec3 along{0};  ///< the force times a length per newton; its tip is at from + along
    double shaftRadius = 0;
    bool operator==(const Arrow&) const = default;
  };
  struct Bar {
    DVec3 from{0};
    DVec3 along{0};  ///< its other end is at from + along
    double radius = 0;
    bool operator==(const Bar&) const = default;
  };
  std::optional<Ball> hip;
  std::optional<Disc> proxy;
  std::optional<Arrow> force;
  std::optional<Ball> brush;  ///< shows as its outline
  std::optional<Bar> scale;

  bool any() const { return hip || proxy || force || brush || scale; }
  bool operator==(const Overlays&) const = default;
};

/// A thin line in space, as wide in the picture wherever it is. What lies behind the surface shines through a little.
struct SpaceLine {
  DVec3 from{0}, to{0};  ///< model units relative to the cloud's origin
  std::array<std::uint8_t, 3> color{};
  double opacity = 1;
  double width_px = 1.5;  ///< shared::kWidestLine_px at most

  bool operator==(const SpaceLine&) const = default;
};

struct FrameOptions {
  ImagePass pass = ImagePass::final;
  ColorBy color = ColorBy::rgb;
  double splatRadius = 0;   ///< of every point, model units; 0: each has its own (DrawnOptions::spacing)
  bool everyPoint = false;  ///< draws all, also where many share a sample and a share of them would do
  bool closeHoles = true;   ///< gaps a few spacings wide take the surface around them, also in depth
  /// Depth is smoothed within the surface, so many pixels to each side, and normals follow from it; 0: normals are
  /// those of the points, blended.
  std::uint32_t smooth_px = 0;
  Raster raster = Raster::compute;
  DVec3 up{0, 1, 0};            ///< unit, along an axis
  std::optional<Bounds> shown;  ///< what colours by height, depth and position span; the cloud's box when not given
  std::optional<std::array<std::uint8_t, 3>> background;  ///< RGB; a quiet gradient when not given
  Overlays overlays;
  /// Drawn over all of it; null: none. A list that was given is not changed: another one comes in its place.
  std::shared_ptr<const std::vector<SpaceLine>> lines;

  bool operator==(const FrameOptions&) const = default;
};

}  // namespace palpate
