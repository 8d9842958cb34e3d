#include "apps/cli/model.hpp"
#include "apps/cli/sharing_options.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "engine/io/saving.hpp"
#include "haptics/sharing/ros.hpp"
#include "haptics/sharing/shared_cloud.hpp"

namespace palpate {

namespace {

struct ServeOptions {
  ModelOptions model;
  NetworkOptions network;
  std::string name, ros, journalFile, saveFile;
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

void serve(Context& context, const ServeOptions& options) {
  if (!options.ros.empty()) requireRosName(options.ros);
  if (options.readOnly && (!options.journalFile.empty() || !options.saveFile.empty()))
    throw UsageError("--read-only: nobody sculpts it; leave --journal and --save out");
  Context::checkWritable(options.saveFile);
  sayWhatIsLost(options.saveFile, context.log());
  const Model model = loadModel(context, options.model, EstimateOn::cpu, &options.network);
  const StopBySignal stop;
  CloudServer server(model.cloud, {.network = options.network.config(),
                                   .name = options.name,
                                   .model = std::filesystem::path(options.model.file).filename().string(),
                                   .mm_per_unit = model.scale.mm_per_unit,
                                   .sculptable = !options.readOnly,
                                   .journal = options.journalFile,
                                   .log = &context.log()});
  context.log().say("serving '{}': {} points of {}; {}", options.name, model.cloud.size(), options.model.file,
                    opennessOf(options.network.config()));
  if (options.ros.empty()) {
    server.serve(StopBySignal::requested(), options.duration_s);
  } else {
    RosCloud ros({.network = options.network.config(), .name = options.ros, .mm_per_unit = model.scale.mm_per_unit});
    serveWith(server, ros, model.cloud, options.duration_s);
  }
  const ServedCounts counts = server.counts();
  context.log().say("served '{}' to {} client{}: {} blocks of points; {} sculpted it, {} states of points in {} pieces",
                    options.name, counts.clients, counts.clients == 1 ? "" : "s", counts.blocks, counts.sculptors,
                    counts.states, counts.pieces);
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
                     {"again", counts.again},
                     {"sent", counts.sent},
                     {"edited", changedPoints(model.cloud, server.points())}});
}

}  // namespace

void addServe(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand(
      "serve", "a model for other programs, here or on other machines, which join it by its name (--join)");
  auto options = std::make_shared<ServeOptions>();
  addModelOptions(sub, options->model);
  sub.add("--name", options->name, "by which it is joined; no other session of the network has it").required();
  sub.add("--journal", options->journalFile,
          "a file that each stroke goes into as it is taken: whoever serves the model again with it goes on where this ends, "
          "and so do those who have joined")
      .typeName("FILE");
  sub.add("--save", options->saveFile, "the points as they are in the end; an older file is kept").typeName("FILE");
  sub.addFlag("--read-only", options->readOnly, "whoever joins feels it and does not sculpt it");
  sub.add("--ros", options->ros, "programs of ROS 2 hear the points as NAME/cloud, and again while they are sculpted")
      .typeName("NAME");
  addNetworkOptions(sub, options->network);
  sub.add("--duration", options->duration_s, "s (default: until it is asked to end, as by Ctrl+C)")
      .check(between(bounds::kShortest_s, bounds::kLongest_s));
  sub.footer(
      "What is served is the points with their normals, colours and scale, as they were read, and what those who join do to "
      "them, in one order for all: each feels what the others do, and in the end all have the same points, bit by bit. "
      "Points are moved, painted and taken away; none come to keep the surface whole (--keep-points).\n"
      "Without --interface nobody but this machine can join; with it, whoever is on that network can, and nothing is "
      "encrypted. With --security all is, and only who has keys of the same authority can join (palpate keys makes them).\n");
  sub.whenNamed([&, options] { command = [&context, options] { serve(context, *options); }; });
}

}  // namespace palpate
