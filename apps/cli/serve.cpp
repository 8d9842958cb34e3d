#include "apps/cli/model.hpp"
#include "apps/cli/sharing_options.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "haptics/sharing/shared_cloud.hpp"

namespace palpate {

namespace {

struct ServeOptions {
  ModelOptions model;
  NetworkOptions network;
  std::string name;
  double duration_s = 0;
};

void serve(Context& context, const ServeOptions& options) {
  const Model model = loadModel(context, options.model, EstimateOn::cpu);
  const StopBySignal stop;
  CloudServer server(model.cloud, {.network = options.network.config(),
                                   .name = options.name,
                                   .model = std::filesystem::path(options.model.file).filename().string(),
                                   .mm_per_unit = model.scale.mm_per_unit,
                                   .log = &context.log()});
  context.log().say("serving '{}': {} points of {}; {}", options.name, model.cloud.size(), options.model.file,
                    opennessOf(options.network.config()));
  server.serve(StopBySignal::requested(), options.duration_s);
  const ServedCounts counts = server.counts();
  context.log().say("served '{}' to {} client{}: {} blocks of points", options.name, counts.clients,
                    counts.clients == 1 ? "" : "s", counts.blocks);
  context.writeJson({{"name", options.name},
                     {"points", model.cloud.size()},
                     {"mm_per_unit", model.scale.mm_per_unit},
                     {"clients", counts.clients},
                     {"requests", counts.requests},
                     {"blocks", counts.blocks},
                     {"pings", counts.pings},
                     {"refused", counts.refused}});
}

}  // namespace

void addServe(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand(
      "serve", "a model for other programs, here or on other machines, which join it by its name (--join)");
  auto options = std::make_shared<ServeOptions>();
  addModelOptions(sub, options->model);
  sub.add("--name", options->name, "by which it is joined; no other session of the network has it").required();
  addNetworkOptions(sub, options->network);
  sub.add("--duration", options->duration_s, "s (default: until it is asked to end, as by Ctrl+C)")
      .check(between(bounds::kShortest_s, bounds::kLongest_s));
  sub.footer(
      "What is served is the points with their normals, colours and scale, as they were read. Without --interface nobody but "
      "this machine can join; with it, whoever is on that network can, and nothing is encrypted.\n");
  sub.whenNamed([&, options] { command = [&context, options] { serve(context, *options); }; });
}

}  // namespace palpate
