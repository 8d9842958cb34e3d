// Contents and appearance of a frame.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/vec.hpp"
#include "shaders/shared/ramp.h"
#include "shaders/shared/render.h"

namespace palpate {

/// The picture, or one of its intermediate images.
enum class ImagePass : std::uint32_t {
  final = shared::kPassFinal,
  depth = shared::kPassDepth,              ///< near is bright
  smoothDepth = shared::kPassSmoothDepth,  ///< likewise, smoothed depth
  normal = shared::kPassNormal,            ///< 0.5 + 0.5 n, model axes, towards the eye
  color = shared::kPassColor,              ///< unlit surface colour
  position = shared::kPassPosition,        ///< 0 to 1 along each side of the model's box
};

/// Source of the surface colour that every model has.
enum class ColorSource : std::uint32_t {
  rgb = shared::kColorByFile,  ///< the file's colours, or one material if it has none
  normal = shared::kColorByNormal,
  depth = shared::kColorByDepth,
  height = shared::kColorByHeight,      ///< along FrameOptions::up
  material = shared::kColorByMaterial,  ///< that of the material, whatever colours the points have
};

/// Colours of numbers.
enum class ColorMap : std::uint32_t {
  viridis = shared::kMapViridis,
  turbo = shared::kMapTurbo,
  grey = shared::kMapGrey,
  redBlue = shared::kMapRedBlue,
  classes = shared::kMapClasses,  ///< of whole numbers, not over a range
  terrain = shared::kMapTerrain,
};

/// The numbers that DrawnAttributes shows, with colours over this range; points without one are grey.
struct FieldColors {
  double low = 0, high = 1;
  std::uint64_t version = 0;  ///< another one: the numbers differ

  bool operator==(const FieldColors&) const = default;
};
/// What the surface's colour shows. Selected points are tinted where it is of the points themselves, not of the surface
/// (normal, depth, height).
using ColorBy = std::variant<ColorSource, FieldColors>;

/// How the surface sends light to the eye.
enum class Material : std::uint32_t {
  clay = shared::kMaterialClay,
  stone = shared::kMaterialStone,
  plaster = shared::kMaterialPlaster,
  metal = shared::kMaterialMetal,
  unlit = shared::kMaterialUnlit,  ///< the colours as they are
  water = shared::kMaterialWater,  ///< of a cloud, by its particles (FrameOptions::particles)
};

/// What adds to the plain light of a picture; each is a pass of its own (Relief, Ground, Shading).
struct Light {
  Material material = Material::clay;
  bool occlusion = false;  ///< hollows are darker, by the share of the sky that is hidden there
  bool cavity = false;     ///< grooves are darker and ridges brighter
  bool ground = false;     ///< soft shadow on the ground at the lowest height along FrameOptions::up
  bool eyeDome = false;    ///< what lies behind what is beside it is darker

  bool operator==(const Light&) const = default;
};

/// Rasteriser of discs. The pictures are equal except for samples on the rims of discs.
enum class Raster : std::uint32_t {
  compute,
  hardware,  ///< the graphics pipeline: point sprites
};

/// Largest width and height of a picture, pixels.
inline constexpr std::uint32_t kMaxSide_px = 16'384;

/// Names on the command line.
inline constexpr std::array<std::pair<std::string_view, ColorSource>, 5> kColorNames{
    {{"rgb", ColorSource::rgb},
     {"material", ColorSource::material},
     {"normal", ColorSource::normal},
     {"depth", ColorSource::depth},
     {"height", ColorSource::height}}};

inline constexpr std::array<std::pair<std::string_view, ColorMap>, 6> kColorMaps{{{"viridis", ColorMap::viridis},
                                                                                  {"turbo", ColorMap::turbo},
                                                                                  {"grey", ColorMap::grey},
                                                                                  {"red-blue", ColorMap::redBlue},
                                                                                  {"classes", ColorMap::classes},
                                                                                  {"terrain", ColorMap::terrain}}};

/// By their names on the command line. Throw UsageError that lists the valid names.
ImagePass imagePassNamed(std::string_view name);
Raster rasterNamed(std::string_view name);

/// Drawn over the surface; parts behind the surface shine through. Model units relative to the cloud's origin.
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
    DVec3 along{0};  ///< the force times a length per newton; the tip is at from + along
    double shaftRadius = 0;
    bool operator==(const Arrow&) const = default;
  };
  struct Bar {
    DVec3 from{0};
    DVec3 along{0};  ///< the other end is at from + along
    double radius = 0;
    bool operator==(const Bar&) const = default;
  };
  std::optional<Ball> hip;
  std::optional<Disc> proxy;
  std::optional<Arrow> force;
  std::optional<Ball> brush;  ///< drawn as an outline
  std::optional<Bar> scale;

  bool any() const { return hip || proxy || force || brush || scale; }
  bool operator==(const Overlays&) const = default;
};

/// A line in space of constant width in the picture. Parts behind the surface shine through a little.
struct SpaceLine {
  DVec3 from{0}, to{0};  ///< model units relative to the cloud's origin
  std::array<std::uint8_t, 3> color{};
  double opacity = 1;
  double width_px = 1.5;  ///< maximum shared::kWidestLine_px

  bool operator==(const SpaceLine&) const = default;
};

/// Points that fill a volume.
struct Particles {
  double radius = 0;           ///< of the ball that is drawn for each in water, model units
  double spacing = 0;          ///< cube root of the volume of each, model units
  std::uint32_t standing = 0;  ///< number of the last points, which are of surfaces

  bool operator==(const Particles&) const = default;
};

struct FrameOptions {
  ImagePass pass = ImagePass::final;
  ColorBy color = ColorSource::rgb;
  ColorMap colorMap = ColorMap::terrain;  ///< of fields, depths and heights
  double splatRadius = 0;  ///< common radius of all points, model units; 0: each has its own (DrawnOptions::spacing)
  /// Composites the Gaussians of a file that has them, in place of discs (showsGaussians()).
  bool gaussians = false;
  bool everyPoint = false;  ///< draws all points, even if a subset suffices because many share a sample
  bool closeHoles = true;   ///< fills gaps of a few spacings from the surface around them, also in depth
  /// Radius in pixels within which depth is smoothed along the surface; normals are then derived from depth. 0: normals
  /// are those of the points, blended.
  std::uint32_t smooth_px = 0;
  Raster raster = Raster::compute;
  Light light;                  ///< of the pass final; its material also colours points without a colour
  Particles particles;          ///< if the material is water
  DVec3 up{0, 1, 0};            ///< unit, along an axis
  std::optional<Bounds> shown;  ///< range of colours by height, depth and position; the cloud's box if not set
  std::optional<std::array<std::uint8_t, 3>> background;  ///< RGB; a dark gradient if not set
  bool transparent = false;   ///< no background: pixels have the opacity of what covers them
  bool tintsSelected = true;  ///< shows which points are selected, and how far they are locked
  bool hidesBacks = false;    ///< draws no surface from its back: one looks into a room through its walls
  Overlays overlays;
  /// Drawn over everything else; null: none. The list must not be changed after it was set; replace it instead.
  std::shared_ptr<const std::vector<SpaceLine>> lines;

  bool operator==(const FrameOptions&) const = default;
};

/// Whether the particles of a cloud are drawn as water: in their own colour, as fields, heights, normals and all other
/// passes are of discs.
bool showsWater(const FrameOptions& options);

}  // namespace palpate
