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
#include "engine/io/saving.hpp"
#include "engine/matter/matter_model.hpp"
#include "haptics/session/matter_scenes.hpp"
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

/// Serves until it is asked to end, or the time is over; meanwhile ROS hears the points as they are, after each second
/// in which they have changed.
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

// What is served, and how it moves.
SessionConfig servedConfig(Context& context, const ServeOptions& options) {
  SessionConfig config{.model = options.model.config()};
  config.backend.name = chooseBackend(context, {.backend = options.backend});
  config.realtime = true;
  config.motion = motionConfig(options.motion);
  config.stream = streamConfig(options.stream, config.model.file);
  config.matter = matterScene(config.model.file);
  validate(config);
  if (config.moves() && (!options.journalFile.empty() || !options.saveFile.empty() || !options.ros.name.empty()))
    throw UsageError("--journal, --save and --ros: are for what stands still; {} moves", config.model.file);
  return config;
}

FarFacts factsOf(const Model& model, const std::optional<MatterScene>& matter) {
  FarFacts facts{
      .spacing = model.spacing, .wideSpacing = model.wideSpacing, .noise = model.noise, .up = model.upright.up};
  if (!matter || matter->matter == Matter::soft) return facts;
  MatterScene scene = *matter;
  scene.model = std::filesystem::path(scene.model).filename().string();  // where it is stored is nobody's business
  facts.matter = sceneText(scene);
  if (model.standing) facts.standing = model.standing->points().size();
  return facts;
}

// Nothing where the model stands still.
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
  parts.motion = [stepped](double time_s, std::span<const SeenHand> hands, CloudFrame& frame) {
    return stepped->step(time_s, hands, frame);
  };
}

void serve(Context& context, const ServeOptions& options) {
  options.ros.check();
  checkRosHearing(options.network, options.model.file, options.stream.live);
  if (options.readOnly && (!options.journalFile.empty() || !options.saveFile.empty()))
    throw UsageError("--read-only: nobody sculpts it; leave --journal and --save out");
  checkOutput(options.saveFile, Output::points);
  checkOutput(options.journalFile, Output::journal);
  sayWhatIsLost(options.saveFile, context.log());
  const SessionConfig config = servedConfig(context, options);
  const auto loaded = std::make_shared<const Model>(loadModel(context, config, EstimateOn::cpu, &options.network));
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
                           .facts = factsOf(model, config.matter)};
  addMotion(parts, context, config, loaded);
  CloudServer server(model.cloud, std::move(parts));
  context.log().say("serving '{}': {} points of {}{}; {}", options.name, model.cloud.size(), config.model.file,
                    config.moves() ? ", which move" : "", opennessOf(options.network.config()));
  std::exception_ptr ended;  // otherwise than it was told to: what was done to the points is saved nevertheless
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
  context.log().say("served '{}' to {} client{}: {} blocks of points; {} sculpted it, {} states of points in {} pieces",
                    options.name, counts.clients, counts.clients == 1 ? "" : "s", counts.blocks, counts.sculptors,
                    counts.states, counts.pieces);
  if (counts.near > 0)
    context.log().say("{} client{} had the points around their hands alone: {} in {} steps{}", counts.near,
                      counts.near == 1 ? "" : "s", counts.nearPoints, counts.nearSteps,
                      config.moves() ? fmt::format(", of {} frames", counts.frames) : std::string());
  if (!options.saveFile.empty()) saveKeeping(options.saveFile, editedCloud(model.cloud, server.points()));
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
                     {"copied", counts.copied},
                     {"again", counts.again},
                     {"sent", counts.sent},
                     {"near", counts.near},
                     {"near_points", counts.nearPoints},
                     {"near_steps", counts.nearSteps},
                     {"frames", counts.frames},
                     {"edited", changedPoints(model.cloud, server.points())}});
  if (ended) std::rethrow_exception(ended);
}

}  // namespace

void addServe(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand(
      "serve", "a model for other programs, here or on other machines, which join it by its name (--join)");
  auto options = std::make_shared<ServeOptions>();
  addModelOptions(sub, options->model, modelsAndStreams(RosModels::clouds), false);
  sub.add("--name", options->name, "by which it is joined; no other session of the network has it").required();
  sub.add("--journal", options->journalFile,
          "a file that each stroke goes into as it is taken: whoever serves the model again with it goes on where this "
          "ends, "
          "and so do those who have joined")
      .typeName("FILE");
  sub.add("--save", options->saveFile, "the points as they are in the end; an older file is kept").typeName("FILE");
  sub.addFlag("--read-only", options->readOnly, "whoever joins feels it and does not sculpt it");
  sub.add("--ros", options->ros.name,
          "programs of ROS 2 hear the points as NAME/cloud, and again while they are sculpted")
      .typeName("NAME");
  addRosParentOptions(sub, options->ros);
  addNetworkOptions(sub, options->network);
  addRosCameraOptions(sub, options->network);
  addMotionOptions(sub, options->motion);
  addStreamOptions(sub, options->stream);
  sub.add("--backend", options->backend, "that moves matter: auto, vulkan or cpu")
      .check(oneOf({"auto", "vulkan", "cpu"}))
      .showDefault();
  sub.add("--duration", options->duration_s, "s (default: until it is asked to end, as by Ctrl+C)")
      .check(between(bounds::kShortest_s, bounds::kLongest_s));
  sub.footer(
      "What is served is the points with their normals, colours and scale, as they were read, and what those who join "
      "do to "
      "them, in one order for all: each feels what the others do, and in the end all have the same points, bit by bit. "
      "Points are moved, painted and taken away; none come to keep the surface whole (--keep-points).\n"
      "A model that moves (--motion, the frames of a depth camera, matter such as jelly, water or sand) goes on by the "
      "clock of this program, and is felt alone: who joins it has the points around the hands, up to 60 times a "
      "second, "
      "and his hands press a soft body, and stir water and sand, as those of one session do (up to eight). So has who "
      "joins with --near what stands still. --journal, --save and --ros are for what stands still.\n"
      "Without --interface nobody but this machine can join; with it, whoever is on that network can, and nothing is "
      "encrypted. With --security all is, and only who has keys of the same authority can join (palpate keys makes "
      "them).\n");
  sub.whenNamed([&, options] { command = [&context, options] { serve(context, *options); }; });
}

}  // namespace palpate
