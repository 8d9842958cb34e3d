// Pictures of `render` and `touch --picture`.
#pragma once

#include "apps/cli/look.hpp"
#include "apps/cli/picture_series.hpp"
#include "engine/render/frame.hpp"
#include "haptics/session/colored_field.hpp"
#include "haptics/session/guides.hpp"
#include "haptics/session/light_config.hpp"

namespace palpate {

struct PictureOptions {
  LookOptions look;
  ColorConfig color;
  LightConfig light;
  std::string guides;  ///< guidesNamed()
  std::string size = "1280x720", camera, splatRadius = "auto", pass = "final", background, depthFile,
              raster = "compute";
  std::vector<CameraRequest> way;  ///< of a series: its cameras are on a smooth way through these; empty: a turntable
  std::uint32_t smooth_px = 0, samples = 4;
  bool printFrame = false, scaleBar = false, everyPoint = false;
  bool cameras = false;  ///< draws the cameras that took pictures of the model
  bool points = false;   ///< draws points instead of discs
};
void addPictureOptions(Options& command, PictureOptions& options);

struct PictureSize {
  std::uint32_t width, height;
};
/// The longest of 1, 2, 5, 10, … units that covers at most a fifth of the picture's width at the depth of the target.
double scaleBarLength(const Camera& camera, const PictureSize& size);
/// A bar of that length at the lower left.
Overlays::Bar scaleBar(const Camera& camera, const PictureSize& size);

/// What is written into a picture once it is drawn, in the window's pictures and the command line's alike.
struct Annotations {
  std::string scale;  ///< length of scaleBar(), above it; empty: there is no bar
  std::optional<Legend> legend;
  std::vector<PictureLabel> labels;
};
void annotate(Image& image, const Annotations& annotations);

/// --guides: guidesNamed().
void addGuidesOption(Options& command, std::string& guides);

/// --samples: 1 or 4.
void addSamplesOption(Options& command, std::uint32_t& samples);

/// Whether a picture shows the points' own colours.
bool showsPaint(const PictureOptions& options);

/// Whether it is of the Gaussians of a splat scene, and not of its surface.
bool showsGaussians(const PictureOptions& options, const PointCloud& cloud);

/// Checks the options of a picture of that name, if any, as far as possible before anything is loaded. Throws
/// UsageError.
void checkPictureOptions(const PictureOptions& options, const std::string& file);

/// The points that are drawn, for their fields.
struct PicturedPoints {
  const PointCloud& cloud;
  std::span<const PointState> states;  ///< by number; empty: as in the cloud
};

/// The field that colours these points; empty: another colour does.
std::optional<ColoredField> coloredField(const Context& context, const Model& model, const PicturedPoints& points,
                                         const PictureOptions& options);

/// Draws `drawn` (the GPU's copy of these points, made with the model's spacing) into `files`. Prints the passes on
/// request.
void takePicture(Context& context, const Model& model, const PicturedPoints& points, DrawnCloud& drawn,
                 const PictureOptions& options, const Overlays& overlays, const PictureFiles& files);

/// The same for a mesh of it, whose vertices have the colours of `field`, if any.
void takePicture(Context& context, const Model& model, const DrawnMesh& drawn, const ColoredField* field,
                 const PictureOptions& options, const Overlays& overlays, const PictureFiles& files);

/// The passes of a recording with their threads, bytes and last GPU times.
void printPasses(std::FILE* out, const std::vector<PassRecord>& passes);

}  // namespace palpate
