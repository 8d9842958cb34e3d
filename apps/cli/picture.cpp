#include "apps/cli/picture.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cli/legend.hpp"
#include "apps/cli/model_lines.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/parse_list.hpp"
#include "apps/cli/setting_options.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/render/camera_motion.hpp"
#include "engine/select/prepared_cloud.hpp"

namespace palpate {

namespace {

constexpr const char* kTransparent = "transparent";

PictureSize parseSize(const std::string& text) {
  const auto [width, height] = parseList<std::uint32_t, 2>(text, 'x', "--size", "WIDTHxHEIGHT in pixels");
  return {width, height};
}

FrameOptions frameOptions(const PictureOptions& options, const Model& model, bool isSoftware = false,
                          const ColoredField* field = nullptr) {
  FrameOptions frame = frameOptionsOf(model, uprightOf(model, options.look).up, options.color, field, options.light,
                                      {.isSoftware = isSoftware, .barePoints = options.points});
  frame.pass = imagePassNamed(options.pass);
  frame.everyPoint = options.everyPoint;
  frame.raster = rasterNamed(options.raster);
  constexpr std::uint32_t kUsualSmooth_px = 3;  // default for the pass smooth-depth
  frame.smooth_px = options.smooth_px > 0 || frame.pass != ImagePass::smoothDepth ? options.smooth_px : kUsualSmooth_px;
  frame.transparent = options.background == kTransparent;
  if (!options.background.empty() && !frame.transparent)
    frame.background =
        parseList<std::uint8_t, 3>(options.background, ',', "--background", "R,G,B from 0 to 255, or transparent");
  // Wider discs hide the model, and cost too much GPU time.
  constexpr double kWidest = 0.1;  // of the longest side
  const double widest = kWidest * model.shownBounds().longestSide();
  if (options.splatRadius != "auto") {
    const double radius_mm =
        parseList<double, 1>(options.splatRadius, ',', "--splat-radius", "a length in mm or 'auto'")[0];
    if (!(radius_mm > 0) || !std::isfinite(radius_mm))
      throw UsageError("--splat-radius: '{}' is not a positive length in mm", options.splatRadius);
    frame.splatRadius = frame.particles.radius = model.scale.toUnits(radius_mm);
    if (widest > 0 && frame.splatRadius > widest)
      throw UsageError("--splat-radius: {} mm is more than a tenth of the model, which is {:.4g} mm long in the hand",
                       radius_mm, model.scale.toMm(widest / kWidest));
  }
  if (options.points) {
    constexpr double kBare = 1e-7;  // of the longest side: far below a sample
    frame.splatRadius = kBare * std::max(model.shownBounds().longestSide(), 1e-30);
    frame.everyPoint = true;
    frame.particles.radius = 0;
    frame.closeHoles = false;
  }
  return frame;
}

constexpr double kScaleShare = 0.2;  // largest length of the scale bar, of the picture's width
constexpr double kScaleEnd = 0.01;   // height of its ends above and below it, of the picture's

DVec2 scaleBarCorner(const PictureSize& size) { return {0.04 * size.width, 0.94 * size.height}; }

}  // namespace

double scaleBarLength(const Camera& camera, const PictureSize& size) {
  const double depth = glm::distance(camera.eye, camera.target);
  return roundLength(kScaleShare * size.width * camera.divisorAt(depth) / camera.focal_px(size.height));
}

Overlays::Bar scaleBar(const Camera& camera, const PictureSize& size) {
  const double depth = glm::distance(camera.eye, camera.target);
  return {.from = camera.unproject(scaleBarCorner(size), depth, {size.width, size.height}),
          .along = scaleBarLength(camera, size) * camera.axes().right,
          .radius = 0.003 * size.height * camera.divisorAt(depth) / camera.focal_px(size.height)};
}

void annotate(Image& image, const Annotations& annotations) {
  const PictureSize size{image.width, image.height};
  LabelRoom room;
  if (!annotations.scale.empty()) {
    const DVec2 corner_px = scaleBarCorner(size), end_px(0, kScaleEnd * size.height);
    drawText(image, corner_px - DVec2(0, 0.015 * size.height), annotations.scale, room);
    room.reserve(corner_px - end_px, corner_px + DVec2(kScaleShare * size.width, 0) + end_px);
  }
  if (annotations.legend) drawLegend(image, *annotations.legend, room);
  for (const PictureLabel& label : annotations.labels) drawLabel(image, label, room);
}

void addPictureOptions(Options& command, PictureOptions& options) {
  addLookOptions(command, options.look);
  command.add("--size", options.size, "WIDTHxHEIGHT, pixels").showDefault();
  command.add(
      "--camera", options.camera,
      "any of \"eye=x,y,z target=x,y,z up=x,y,z fov=45 ortho=HEIGHT\", model units and degrees, and front, back, left, "
      "right, top, bottom or isometric (default: in front of the model, slightly above); ortho: orthographic, "
      "HEIGHT from the lower to the upper border, or as the model requires; isometric: orthographic, from the "
      "front, the right and above");
  command
      .add("--splat-radius", options.splatRadius,
           "radius of the discs, mm; auto: just wide enough to close the surface")
      .showDefault();
  addSettings(command, options.color, {});
  addSettings(command, options.light, {});
  addGuidesOption(command, options.guides);
  command.add("--pass", options.pass, "image to write: final, depth, smooth-depth, normal, color or position")
      .showDefault();
  command
      .add("--smooth", options.smooth_px,
           "radius of the depth smoothing, pixels; normals are then derived from depth. 0: blend the "
           "normals of the points")
      .check(inRange(0u, shared::kMaxSmooth_px / 2))
      .showDefault();
  addSamplesOption(command, options.samples);
  command.addFlag("--every-point", options.everyPoint, "draw every point, even where points are denser than samples");
  command
      .add("--raster", options.raster,
           "rasteriser of the discs: compute (compute shaders) or hardware; the picture is the same")
      .showDefault();
  command.add("--background", options.background, "R,G,B, 0 to 255 each, or transparent (PNG) (default: a gradient)");
  command.add("--depth", options.depthFile, "also write eye-space depth as PFM, model units")
      .typeName("FILE.pfm")
      .writes(Writes::replacing);
  command.addFlag("--scale-bar", options.scaleBar,
                  "draw a scale bar in the unit of the file, at the depth of the camera target");
  command.addFlag("--cameras", options.cameras,
                  "draw the cameras of a COLMAP folder, of a fused.ply or of a depth camera as pyramids");
  command.addFlag("--print-frame", options.printFrame,
                  "list the GPU passes of the frame with threads, bytes and GPU time, us");
}

void addGuidesOption(Options& command, std::string& guides) {
  command.add("--guides", guides,
              "any of box,axes,grid,compass: the model's box with its lengths, its axes with coordinates, squares of a "
              "round length on the ground, the directions of the axes");
}

void addSamplesOption(Options& command, std::uint32_t& samples) {
  command.add("--samples", samples, "samples per pixel: 4 (antialiased) or 1 (faster)")
      .check(oneOf({1u, 4u}))
      .showDefault();
}

void checkPictureOptions(const PictureOptions& options, const std::string& file) {
  const PictureSize size = parseSize(options.size);
  Frame::checkSize(size.width, size.height);
  validate(options.color);
  frameOptions(options, Model{});
  guidesNamed(options.guides, "--guides");
  Camera::parse(options.camera, PointCloud{}, 1);
  checkOutput(options.depthFile, Output::only);
  if (options.background != kTransparent || file.empty()) return;
  if (isFilm(file) || imageFormatOf(file) != ImageFormat::png)
    throw UsageError("--background: {} cannot be transparent; name a .png file", file);
}

bool showsPaint(const PictureOptions& options) {
  const ImagePass pass = imagePassNamed(options.pass);
  return options.color.source() == ColorSource::rgb && (pass == ImagePass::final || pass == ImagePass::color);
}

bool showsGaussians(const PictureOptions& options, const PointCloud& cloud) {
  return showsPaint(options) && drawsGaussians(options.light.gaussians, cloud, options.points);
}

void printPasses(std::FILE* out, const std::vector<PassRecord>& passes) {
  fmt::print(out, "{:<24} {:<32} {:>12} {:>12} {:>6} {:>10}\n", "section", "pass", "threads", "bytes", "waits",
             "GPU us");
  for (const PassRecord& pass : passes)
    fmt::print(out, "{:<24} {:<32} {:>12} {:>12} {:>6} {:>10.1f}\n", pass.section, pass.name, pass.threads, pass.bytes,
               pass.waits ? "yes" : "no", pass.gpu_us);
}

namespace {

// The camera of each file: as requested, or around the model, with the same framing for all.
std::vector<Camera> camerasFor(const PictureFiles& files, const PictureOptions& options, const Model& model,
                               const PictureGuides& guides, UpAxis up, double aspect) {
  Framing framing = framingOf(model, up);
  // With lines beside the points, the picture shows all their positions.
  const bool showsLines = !model.cloud.empty() && (model.container() || (options.cameras && !model.cameras.empty()) ||
                                                   !guides.still().labels.empty());
  if (showsLines) framing.shown.reset();
  PointCloud beside = showsLines ? placesWithLines(model, options.cameras) : PointCloud();
  for (const SpaceLabel& label : guides.still().labels) beside.positions.emplace_back(label.at);
  for (const SpaceLine& line : guides.still().lines) beside.positions.emplace_back(line.to);
  const PointCloud& shown = showsLines ? beside : model.cloud;
  if (files.each.size() == 1) return {Camera::parse(options.camera, shown, aspect, framing)};
  if (!options.way.empty()) {
    std::vector<Camera> through, cameras;
    for (const CameraRequest& request : options.way) through.push_back(Camera::asked(request, shown, aspect, framing));
    const double step = static_cast<double>(through.size() - 1) / static_cast<double>(files.each.size() - 1);
    for (std::size_t k = 0; k < files.each.size(); ++k) {
      cameras.push_back(alongCameras(through, static_cast<double>(k) * step));
      cameras.back().setDepthRange(boundsOf(shown), through.front().farDepth - through.front().nearDepth);
    }
    return cameras;
  }
  const DVec3 middle = framing.shown.value_or(boundsOf(shown)).center();
  const PointCloud outline = revolved(shown, framing);
  framing.shown.reset();
  const Camera first = Camera::parse(options.camera, outline, aspect, framing);
  const DVec3 pivot = CameraRequest::parse(options.camera).target ? first.target : middle;
  std::vector<Camera> cameras;
  for (std::size_t k = 0; k < files.each.size(); ++k) {
    constexpr double kAround = 2;  // heights of the picture
    const double share = static_cast<double>(k) / static_cast<double>(files.each.size());
    Camera camera = orbited(first, pivot, {kAround * share, 0}, DVec2(1));
    camera.setDepthRange(boundsOf(shown), boundsOf(outline).longestSide());
    cameras.push_back(camera);
  }
  return cameras;
}

template <class Drawn>
void draw(Context& context, const Model& model, const Drawn& drawn, const PictureOptions& options,
          const Overlays& overlays, const PictureFiles& files, const ColoredField* field = nullptr) {
  Device& device = context.device();
  const PictureSize size = parseSize(options.size);
  const double aspect = static_cast<double>(size.width) / std::max(1u, size.height);
  FrameOptions frameOf = frameOptions(options, model, device.isCpu(), field);
  frameOf.overlays = overlays;
  const Upright upright = uprightOf(model, options.look);
  const LengthUnit unit = unitOf(model.cloud, options.look);
  const PictureGuides guides(guidesNamed(options.guides, "--guides"), model, upright.up, unit);
  const std::vector<SpaceLine> lines = modelLines(model, options.cameras);
  const std::string& name = files.name;
  if (options.cameras && model.cameras.empty())
    context.log().say("{}: no cameras are drawn: the model has no camera poses", name);
  Frame frame(device, size.width, size.height, options.samples > 1 ? 2 : 1);
  if (model.cloud.empty())
    context.log().say("{}: the model has no points, and the picture is empty", name);
  else if (!upNamed(options.look.up))
    context.log().say("{}: up is {}: {}", name, nameOf(upright.up), upright.why);
  if (const std::string note = hiddenBacksNote(model, options.light); !note.empty())
    context.log().say("{}: {}", name, note);
  const std::vector<Camera> cameras = camerasFor(files, options, model, guides, upright.up, aspect);
  Annotations annotations;
  if (options.scaleBar) annotations.scale = lengthText(scaleBarLength(cameras.front(), size), unit);
  if (options.scaleBar) context.log().say("{}: the scale bar is {} long", name, annotations.scale);
  const bool hasLegend = (frameOf.pass == ImagePass::final || frameOf.pass == ImagePass::color) && !model.cloud.empty();
  if (hasLegend && field) annotations.legend = field->legend(options.color);
  if (hasLegend && frameOf.color == ColorBy(ColorSource::height))
    annotations.legend = heightLegend(model, upright.up, unit, frameOf.colorMap);
  CommandList list(device, device.throughputQueue(), "frame",
                   options.printFrame ? CommandList::Timing::passes : CommandList::Timing::none);
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    if (options.scaleBar) frameOf.overlays.scale = scaleBar(cameras[k], size);
    const UVec2 size_px(size.width, size.height);
    frameOf.lines = guides.linesWith(lines, cameras[k], size_px);
    annotations.labels = guides.labelsIn(cameras[k], size_px);
    list.begin();
    frame.record(list, drawn, cameras[k], frameOf);
    list.end();
    device.throughputQueue().run(list);
    Image image = frame.readColor();
    annotate(image, annotations);
    writeImage(files.each[k], image);
  }
  if (!options.depthFile.empty()) writePfm(options.depthFile, frame.readDepth());
  if (options.printFrame) printPasses(context.tables(), list.passes());
}

}  // namespace

std::optional<ColoredField> coloredField(const Context& context, const Model& model, const PicturedPoints& points,
                                         const PictureOptions& options) {
  if (options.color.source()) return std::nullopt;
  const UpAxis up = uprightOf(model, options.look).up;
  ColoredField field(options.color, points.cloud, std::vector<Field>(),
                     FieldOptions{.mm_per_unit = mmPerUnit(points.cloud, 0), .up = up, .threads = context.threads()},
                     unitOf(model.cloud, options.look));
  std::vector<PointState> loaded;
  if (points.states.empty()) loaded = statesOf(points.cloud);
  const std::span<const PointState> states = points.states.empty() ? std::span(loaded) : points.states;
  field.read(states, {}, shownPoints(states, {}));
  return field;
}

void takePicture(Context& context, const Model& model, const PicturedPoints& points, DrawnCloud& drawn,
                 const PictureOptions& options, const Overlays& overlays, const PictureFiles& files) {
  drawn.closeSurface();
  requireGaussians(options.light.gaussians, model.cloud, "--splats");
  if (showsGaussians(options, points.cloud)) context.log().say("{}: {}", files.name, drawn.gaussians()->inWords());
  const std::optional<ColoredField> field = coloredField(context, model, points, options);
  if (field) drawn.attributes().show(field->floats());
  draw(context, model, drawn, options, overlays, files, field ? &*field : nullptr);
}

void takePicture(Context& context, const Model& model, const DrawnMesh& drawn, const ColoredField* field,
                 const PictureOptions& options, const Overlays& overlays, const PictureFiles& files) {
  draw(context, model, drawn, options, overlays, files, field);
}

}  // namespace palpate
