#include "apps/picture.hpp"

namespace palpate {

namespace {

struct RenderOptions {
  ModelOptions model;
  PictureOptions picture;
  std::string output;
};

void render(Context& context, const RenderOptions& options) {
  checkPictureOptions(options.picture);
  context.checkWritable(options.output);
  const Model model = loadModel(context, options.model, EstimateOn::gpu);
  DrawnCloud drawn(context.device(), model.cloud, {.spacing = model.spacing});
  takePicture(context, model, drawn, options.picture, {}, options.output);
  context.log().say("{}: {} points of {}", options.output, model.cloud.size(), options.model.file);
  context.writeJson({{"file", options.output}, {"points", model.cloud.size()}, {"gpu", context.device().name()}});
}

}  // namespace

void addRender(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand("render", "a picture of a model, headless");
  auto options = std::make_shared<RenderOptions>();
  addModelOptions(*sub, options->model);
  sub->add_option("-o,--output", options->output, "PNG file to write")->required()->type_name("IMG.png");
  addPictureOptions(*sub, options->picture);
  sub->callback([&, options] { command = [&context, options] { render(context, *options); }; });
}

}  // namespace palpate
