#include "apps/cli/mesh_options.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/picture.hpp"
#include "apps/cli/sharing_options.hpp"
#include "apps/cli/stream_options.hpp"
#include "engine/core/counted.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/text_lines.hpp"

namespace palpate {

namespace {

struct RenderOptions {
  ModelOptions model;
  StreamOptions stream;
  JoinOptionsGiven join;
  PictureOptions picture;
  MeshChoices mesh;
  std::string output, mode = "splat";
  std::uint32_t turntable = 0, frames = 0;  ///< pictures of a turntable, or along cameraPath; 0: none, or kUsualFrames
  std::string cameraPath;                   ///< a file; empty: none
};

constexpr std::uint32_t kUsualFrames = 240;

std::vector<CameraRequest> camerasIn(const std::string& file) {
  TextLines lines(file);
  std::vector<CameraRequest> cameras;
  while (const auto line = lines.next()) {
    try {
      cameras.push_back(CameraRequest::parse(*line));
    } catch (const UsageError& error) {
      lines.fail(error.what());
    }
    if (const CameraRequest& camera = cameras.back(); camera.eye && camera.target && *camera.eye == *camera.target)
      lines.fail("eye and target are the same point");
    const auto isFlat = [](const CameraRequest& camera) { return camera.ortho || camera.side == ModelSide::isometric; };
    if (isFlat(cameras.front()) != isFlat(cameras.back()))
      lines.fail("this camera is orthographic and the first is not, or the other way round");
  }
  if (cameras.size() < 2) throw FileError(file, "has fewer than two cameras; a way needs a camera in each line");
  return cameras;
}

/// Number of pictures of a series; 0: one picture.
std::uint32_t picturesOf(const RenderOptions& options) {
  if (options.cameraPath.empty()) return options.turntable;
  return options.frames > 0 ? options.frames : kUsualFrames;
}

void checkRenderOptions(const Context& context, const RenderOptions& options) {
  checkPictureOptions(options.picture, options.output);
  const auto refuseBoth = [](const char* one, const char* other) { throw UsageError("{}: leave out {}", one, other); };
  if (options.frames > 0 && options.cameraPath.empty())
    throw UsageError("--frames: is the number of pictures along a --camera-path");
  if (!options.cameraPath.empty() && options.turntable > 0) refuseBoth("--camera-path", "--turntable");
  if (!options.cameraPath.empty() && !options.picture.camera.empty()) refuseBoth("--camera-path", "--camera");
  if (picturesOf(options) > 0) {
    if (!options.picture.depthFile.empty())
      throw UsageError("--depth: is of one picture; leave out --turntable and --camera-path");
    checkSeries(context, options.output, picturesOf(options));
  } else {
    checkOutput(options.output, Output::picture);
  }
  if (options.model.file.empty() && options.join.name.empty())
    throw UsageError("model: is required; name a file, or a session with --join");
}

void drawMesh(Context& context, Model& model, const RenderOptions& options, const PictureFiles& files) {
  const auto field = coloredField(context, model, {.cloud = model.cloud, .states = {}}, options.picture);
  if (field) model.cloud.colors = field->pointColors(options.picture.color);
  const MeshPlan plan = planFor(model, options.mesh);
  MarchingCubes cubes = makeCubes(context, model, plan);
  cubes.build();
  requireTriangles(cubes, model, plan, options.model.file);
  takePicture(context, model, drawnMesh(cubes, model), field ? &*field : nullptr, options.picture, {}, files);
}

void render(Context& context, RenderOptions& options) {
  checkRenderOptions(context, options);
  if (!options.cameraPath.empty()) options.picture.way = camerasIn(options.cameraPath);
  const ModelConfig chosen = chosenModel(options.model, options.stream, options.join, context.log());
  validate(SessionConfig{.model = chosen, .realtime = chosen.stream && chosen.stream->live});
  Model model = loadModel(context, chosen, EstimateOn::gpu, &options.join.network);
  if (model.cloud.empty()) throw FileError(chosen.file, "contains no points; there is nothing to draw");
  std::optional<PictureSeries> series;
  if (picturesOf(options) > 0) series.emplace(options.output, picturesOf(options));
  const PictureFiles files = series ? series->files() : PictureFiles{options.output, {options.output}};
  Json result{{"file", options.output}, {"points", model.cloud.size()}, {"gpu", context.device().name()}};
  if (options.mode == "mesh") {
    drawMesh(context, model, options, files);
  } else {
    DrawnCloud drawn(context.device(), model.cloud, {.spacing = model.spacingOfDiscs()});
    PictureOptions picture = options.picture;
    picture.points = options.mode == "points";
    takePicture(context, model, {.cloud = model.cloud, .states = {}}, drawn, picture, {}, files);
    if (showsGaussians(picture, model.cloud)) result["gaussians"] = drawn.gaussians()->count();
  }
  if (series) series->finish();
  context.log().say("{}: {}{} of {}", options.output, options.mode == "mesh" ? "mesh through " : "",
                    counted(model.cloud.size(), "point"), chosen.file);
  context.writeJson(result);
}

}  // namespace

void addRender(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("render", "render a picture of a model, headless");
  auto options = std::make_shared<RenderOptions>();
  addModelOptions(sub, options->model, modelsAndStreams() + " (the first frame is drawn)", false);
  sub.add("-o,--output", options->output, "output: .png or .jpg")
      .required()
      .typeName("IMG.png")
      .writes(Writes::replacing);
  sub.add("--turntable", options->turntable,
          "draw this many pictures from all around, and number the files: -o turn-%03d.png, or a film: -o turn.mp4 (by "
          "ffmpeg, 30 pictures a second); replaces nothing without --force")
      .check(inRange(2, 3600));
  sub.add("--camera-path", options->cameraPath,
          "draw pictures along a smooth way through the cameras of a file, each a line as for --camera; -o as for "
          "--turntable")
      .typeName("FILE.txt");
  sub.add("--frames", options->frames,
          fmt::format("number of pictures along --camera-path (default: {})", kUsualFrames))
      .check(inRange(2, 36'000));
  sub.add("--mode", options->mode,
          "splat: a disc per point; points: a sample per point; mesh: the triangles of palpate mesh")
      .check(oneOf({"splat", "points", "mesh"}))
      .showDefault();
  addPictureOptions(sub, options->picture);
  addMeshOptions(sub, options->mesh);
  sub.heading("Depth camera");
  addDepthOptions(sub, options->stream);
  sub.heading("Shared session");
  addJoinOptions(sub, options->join, JoinAs::onlooker);
  sub.heading("Options");
  sub.whenNamed([&, options] { command = [&context, options] { render(context, *options); }; });
}

}  // namespace palpate
