#include "apps/cli/mesh_options.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/picture.hpp"
#include "apps/cli/sharing_options.hpp"
#include "apps/cli/stream_options.hpp"
#include "engine/core/counted.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

struct RenderOptions {
  ModelOptions model;
  StreamOptions stream;
  JoinOptionsGiven join;
  PictureOptions picture;
  MeshChoices mesh;
  std::string output, mode = "splat";
  std::uint32_t turntable = 0;  ///< pictures; 0: one from the camera
};

void checkRenderOptions(const Context& context, const RenderOptions& options) {
  checkPictureOptions(options.picture, options.output);
  if (options.turntable > 0) {
    if (!options.picture.depthFile.empty()) throw UsageError("--depth: is of one picture; leave out --turntable");
    checkTurntable(context, options.output, options.turntable);
  } else {
    checkOutput(options.output, Output::picture);
  }
  if (options.model.file.empty() && options.join.name.empty())
    throw UsageError("model: is required; name a file, or a session with --join");
}

void drawMesh(Context& context, Model& model, const RenderOptions& options, const PictureFiles& files) {
  const auto field = coloredField(context, model, {.cloud = model.cloud, .states = {}}, options.picture);
  if (field) model.cloud.colors = field->pointColors(options.picture.color);
  MarchingCubes cubes = makeCubes(context, model, planFor(model, options.mesh));
  cubes.build();
  takePicture(context, model, drawnMesh(cubes, model), field ? &*field : nullptr, options.picture, {}, files);
}

void render(Context& context, const RenderOptions& options) {
  checkRenderOptions(context, options);
  const ModelConfig chosen = chosenModel(options.model, options.stream, options.join, context.log());
  validate(SessionConfig{.model = chosen, .realtime = chosen.stream && chosen.stream->live});
  Model model = loadModel(context, chosen, EstimateOn::gpu, &options.join.network);
  if (model.cloud.empty()) throw FileError(chosen.file, "contains no points; there is nothing to draw");
  std::optional<Turntable> turntable;
  if (options.turntable > 0) turntable.emplace(options.output, options.turntable);
  const PictureFiles files = turntable ? turntable->files() : PictureFiles{options.output, {options.output}};
  if (options.mode == "mesh") {
    drawMesh(context, model, options, files);
  } else {
    DrawnCloud drawn(context.device(), model.cloud, {.spacing = model.spacingOfDiscs()});
    PictureOptions picture = options.picture;
    picture.points = options.mode == "points";
    takePicture(context, model, {.cloud = model.cloud, .states = {}}, drawn, picture, {}, files);
  }
  if (turntable) turntable->finish();
  context.log().say("{}: {}{} of {}", options.output, options.mode == "mesh" ? "mesh through " : "",
                    counted(model.cloud.size(), "point"), chosen.file);
  context.writeJson({{"file", options.output}, {"points", model.cloud.size()}, {"gpu", context.device().name()}});
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
