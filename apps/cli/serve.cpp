#include <exception>

#include "apps/cli/backend.hpp"
#include "apps/cli/model.hpp"
#include "apps/cli/motion_options.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/sharing_options.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "apps/cli/stream_options.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "engine/io/saving.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/session/stepped_model.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/shared_cloud.hpp"

namespace palpate {

namespace {

struct ServeOptions {
  ModelOptions model;
  MotionOptions motion;
  StreamOptions stream;
  std::string backend = "auto";
  NetworkOptions network;
  RosNameOptions ros;
  std::string name, journalFile, saveFile;
  bool readOnly = false;
  double duration_s = 0;
};

/// Serves until a stop is requested or the time is over; publishes the present points for ROS meanwhile, after each
/// second in which they have changed.
void serveWith(CloudServer& server, RosCloud& ros, const PointCloud& cloud, double duration_s) {
  constexpr double kAgain_s = 1;
  std::optional<std::uint64_t> shownStates;
  for (const Stopwatch since; !StopBySignal::requested();) {
    const double left_s = duration_s > 0 ? duration_s - since.elapsed_s() : kAgain_s;
    if (left_s <= 0) break;
    const std::uint64_t states = server.counts().states;
    if (shownStates != states && ros.show(server.points(), cloud.origin)) shownStates = states;
    server.serve(StopBySignal::requested(), std::min(kAgain_s, left_s));
  }
}

// The configuration of the served model and its motion.
SessionConfig servedConfig(Context& context, const ServeOptions& options) {
  SessionConfig config{.model = options.model.config()};
  config.backend.name = chooseBackend(context, {.backend = options.backend}).name;
  config.realtime = true;
  config.motion = motionConfig(options.motion);
  setSource(config.model, options.stream);
  validate(config);
  if (config.moves() && (!options.journalFile.empty() || !options.saveFile.empty() || !options.ros.name.empty()))
    throw UsageError("--journal, --save and --ros: require a model that does not move; {} moves", config.model.file);
  return config;
}

FarFacts factsOf(const Model& model, const SceneRef& scene) {
  FarFacts facts{
      .spacing = model.spacing, .wideSpacing = model.wideSpacing, .noise = model.noise, .up = model.upright.up};
  if (scene) facts.matter = scene->servedText();
  facts.standing = model.standing();
  return facts;
}

// No effect if the model stands still.
void addMotion(CloudServer::Parts& parts, Context& context, const SessionConfig& config,
               const std::shared_ptr<const Model>& model) {
  if (!config.moves()) return;
  auto stepped =
      std::make_shared<SteppedModel>(config, model,
                                     SteppedModel::Parts{.backend = context.backends().named(config.backend.name),
                                                         .threads = context.threads(),
                                                         .log = &context.log()});
  parts.motion_Hz = stepped->rate_Hz();
  parts.restarts = [stepped] { return stepped->restarts(); };
  parts.motion = [stepped](double time_s, std::span<SeenHand> hands, CloudFrame& frame) {
    return stepped->step(time_s, hands, frame);
  };
}

void serve(Context& context, const ServeOptions& options) {
  options.ros.check();
  checkRosHearing(options.network, options.model.file, options.stream.live);
  if (options.readOnly && (!options.journalFile.empty() || !options.saveFile.empty()))
    throw UsageError("--read-only: the model is not sculpted; leave --journal and --save out");
  checkOutput(options.saveFile, Output::points);
  checkOutput(options.journalFile, Output::only);
  sayWhatIsLost(options.saveFile, context.log());
  const SessionConfig config = servedConfig(context, options);
  const auto loaded =
      std::make_shared<const Model>(loadModel(context, config.model, EstimateOn::cpu, &options.network));
  const Model& model = *loaded;
  if (model.cloud.empty()) throw FileError(config.model.file, "contains no points; there is nothing to serve");
  const StopBySignal stop;
  CloudServer::Parts parts{.network = options.network.config(),
                           .name = options.name,
                           .model = std::filesystem::path(config.model.file).filename().string(),
                           .mm_per_unit = model.scale.mm_per_unit,
                           .sculptable = !options.readOnly && !config.moves(),
                           .journal = options.journalFile,
                           .log = &context.log(),
                           .facts = factsOf(model, config.model.matter),
                           .save = saverTo(options.saveFile)};
  addMotion(parts, context, config, loaded);
  CloudServer server(model.cloud, std::move(parts));
  context.log().say("serving '{}': {} of {}{}; {}", options.name, counted(model.cloud.size(), "point"),
                    config.model.file, config.moves() ? ", which move" : "", opennessOf(options.network.config()));
  std::exception_ptr ended;  // by a failure: the edited points are saved nevertheless
  try {
    if (options.ros.name.empty()) {
      server.serve(StopBySignal::requested(), options.duration_s);
    } else {
      RosCloud ros(options.ros.publishing(options.network, model.scale.mm_per_unit));
      serveWith(server, ros, model.cloud, options.duration_s);
    }
  } catch (const NetworkError&) {
    ended = std::current_exception();
  }
  const ServedCounts counts = server.counts();
  context.log().say("served '{}' to {}: {} of points; {} sculpted it, {} states of points in {}", options.name,
                    counted(counts.clients, "client"), counted(counts.blocks, "block"), counts.sculptors, counts.states,
                    counted(counts.pieces, "piece"));
  if (counts.partial > 0)
    context.log().say("{} streamed only the points around their hands: {} in {}{}", counted(counts.partial, "client"),
                      counted(counts.partialPoints, "point"), counted(counts.partialSteps, "step"),
                      config.moves() ? fmt::format(", of {}", counted(counts.frames, "frame")) : std::string());
  if (!options.saveFile.empty()) server.save();
  context.writeJson({{"name", options.name},
                     {"points", model.cloud.size()},
                     {"mm_per_unit", model.scale.mm_per_unit},
                     {"clients", counts.clients},
                     {"requests", counts.requests},
                     {"blocks", counts.blocks},
                     {"pings", counts.pings},
                     {"refused", counts.refused},
                     {"sculptors", counts.sculptors},
                     {"pieces", counts.pieces},
                     {"states", counts.states},
                     {"duplicate_pieces", counts.again},
                     {"sent", counts.sent},
                     {"partial", counts.partial},
                     {"partial_points", counts.partialPoints},
                     {"partial_steps", counts.partialSteps},
                     {"frames", counts.frames},
                     {"edited", changedPoints(model.cloud, server.points())}});
  if (ended) std::rethrow_exception(ended);
}

}  // namespace

void addServe(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("serve", "serve a model to other palpate programs, which join it by name (--join)");
  auto options = std::make_shared<ServeOptions>();
  addModelOptions(sub, options->model, modelsAndStreams(RosModels::clouds), false);
  sub.add("--name", options->name, "name by which others join; unique on the network").required();
  sub.add("--journal", options->journalFile,
          "append each stroke to this file; serving the model again with the file resumes from there, "
          "and so do the hands that had joined")
      .typeName("FILE")
      .writes(Writes::keeping);
  sub.add("--save", options->saveFile,
          "write the final points, and the present ones when a participant saves; an existing file is kept as a "
          "backup")
      .typeName("OUT.ply")
      .writes(Writes::keeping);
  sub.addFlag("--read-only", options->readOnly, "participants feel the model and cannot sculpt it");
  sub.add("--ros", options->ros.name, "publish the points for ROS 2 as NAME/cloud, also while they are sculpted")
      .typeName("NAME");
  addRosParentOptions(sub, options->ros);
  addNetworkOptions(sub, options->network);
  addRosCameraOptions(sub, options->network);
  addMotionOptions(sub, options->motion);
  addStreamOptions(sub, options->stream);
  sub.add("--backend", options->backend, "back end of simulations: auto, vulkan or cpu")
      .check(oneOf({"auto", "vulkan", "cpu"}))
      .showDefault();
  sub.add("--duration", options->duration_s, "duration, s (default: until interrupted, e.g. by Ctrl+C)")
      .check(between(bounds::kShortest_s, bounds::kLongest_s));
  sub.footer(
      "All participants receive each other's strokes in one order and end with bit-identical "
      "points. Points are moved, painted and removed; none are inserted (--no-resample).\n"
      "A moving model (--motion, a depth camera, jelly, water, sand) advances by the clock of this "
      "program and is streamed around each hand up to 60 times a second; up to eight hands press or "
      "stir it, and cannot sculpt it. --journal, --save and --ros require a model at rest.\n"
      "Without --interface only programs on this machine can join. With it, every machine on that "
      "network can, and nothing is encrypted; --security encrypts everything and admits only "
      "holders of keys of the same authority (see palpate keys).\n");
  sub.whenNamed([&, options] { command = [&context, options] { serve(context, *options); }; });
}

}  // namespace palpate
