#include <filesystem>
#include <thread>

#include "apps/model.hpp"
#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/statistics.hpp"
#include "engine/touch/touch_side.hpp"
#include "haptics/builtin_path.hpp"

namespace palpate {

namespace {

struct BenchOptions {
  std::vector<std::string> names, models;
  std::vector<std::int64_t> sizes;
  std::int64_t repeat = 200;
  double rate_Hz = 1000;
};

// What is measured: a file, or a sculpture of so many points.
struct Subject {
  std::string name;
  Model model;
};

Subject loadSubject(Context& context, const std::string& file) {
  return {std::filesystem::path(file).filename().string(), loadModel(context, {.file = file})};
}

Subject makeSubject(Context& context, std::size_t count) {
  const auto shape = makeShape("sculpture");
  Subject subject{.name = fmt::format("sculpture {}", count)};
  subject.model.cloud = sampleShape(*shape, {.count = count, .threads = context.threads()});
  subject.model.scale = {1};
  subject.model.spacing = meanSpacing(subject.model.cloud, context.threads());
  return subject;
}

Json toJson(const Summary& s) {
  return {{"n", s.count}, {"min", s.min}, {"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
}

std::string show(const Summary& s) { return fmt::format("{:.1f} / {:.1f}", s.p50, s.p999); }

// The full build of the index in steady state: the points stand in last tick's order. The first build is told apart.
Json benchBuild(Context& context, const Subject& subject, const BenchOptions& options) {
  Device& device = context.device();
  const PointCloud& cloud = subject.model.cloud;
  const double radius = supportRadius("auto", subject.model);
  LiveCloud live(device, cloud);
  const SpatialHash hash(device, makeHashGrid(Vec3(boundsOf(cloud).min), radius, cloud.size()), live.count());
  std::vector<std::unique_ptr<CommandList>> lists;
  for (int parity = 0; parity < 2; ++parity) {
    lists.push_back(std::make_unique<CommandList>(device, device.touch(), "build", CommandList::Timing::sections));
    lists.back()->begin();
    hash.recordBuild(*lists.back(), live.side(), live.otherSide(), live.count(), hash.sort());
    lists.back()->end();
    live.flip();
  }
  std::vector<double> first, steady;
  for (std::int64_t i = 0; i <= options.repeat; ++i) {
    device.touch().run(*lists[live.parity()]);
    (i == 0 ? first : steady).push_back(lists[live.parity()]->sectionTime_us("hash"));
    live.flip();
  }
  const Summary summary = summarize(steady);
  fmt::print(context.tables(), "{:<28} {:>11} {:>12.1f} {:>20}\n", subject.name, cloud.size(), first[0], show(summary));
  return {{"subject", subject.name}, {"points", cloud.size()}, {"first_us", first[0]}, {"steady_us", toJson(summary)}};
}

struct StepTimes {
  Summary gpu_us, wall_us, edit_us;
};

// A press at `rate_Hz`: the HIP rests inside the surface, so every tick has contact; when editing, the surface yields
// so slowly that every tick edits.
StepTimes measureSteps(Context& context, const Model& model, const BenchOptions& options, bool edited) {
  TouchOptions touchOf{.radius = supportRadius("auto", model)};
  if (edited)
    touchOf.push = PushOptions{.tau = model.scale.toUnits(0.1), .beta = 1e-4, .toolRadius = model.scale.toUnits(6)};
  TouchSide touch(context.device(), model.cloud, touchOf);
  const Path path = builtinPath("press", model.cloud, model.scale);
  const auto approach = static_cast<std::int64_t>(path.duration_s() * 1000);
  std::vector<double> gpu, wall;
  const Stopwatch session;
  for (std::int64_t i = 0; i < approach + options.repeat; ++i) {
    if (i >= approach)  // paced like a servo loop, since a GPU that is always busy answers sooner than one at rest
      while (session.elapsed_s() < static_cast<double>(i) / options.rate_Hz) std::this_thread::yield();
    const double t_s = static_cast<double>(i) * 1e-3;
    const Stopwatch watch;
    const Contact contact = touch.query({.time_s = t_s, .hip = path.at(t_s)}, 0);
    const double time_us = watch.elapsed_us();
    if (!contact.valid) touch.finish();
    if (i < approach) continue;
    wall.push_back(time_us);
    gpu.push_back(contact.gpu_us);
  }
  touch.finish();
  return {summarize(gpu), summarize(wall), summarize(touch.editTimes_us())};
}

Json benchStep(Context& context, const Subject& subject, const BenchOptions& options) {
  const StepTimes still = measureSteps(context, subject.model, options, false);
  const StepTimes edited = measureSteps(context, subject.model, options, true);
  fmt::print(context.tables(), "{:<28} {:>11} {:>18} {:>20} {:>18} {:>20}\n", subject.name, subject.model.cloud.size(),
             show(still.gpu_us), show(still.wall_us), show(edited.edit_us), show(edited.wall_us));
  return {{"subject", subject.name},
          {"points", subject.model.cloud.size()},
          {"static", {{"gpu_us", toJson(still.gpu_us)}, {"pose_to_force_us", toJson(still.wall_us)}}},
          {"edited",
           {{"query_gpu_us", toJson(edited.gpu_us)},
            {"edit_gpu_us", toJson(edited.edit_us)},
            {"pose_to_force_us", toJson(edited.wall_us)}}}};
}

void bench(Context& context, const BenchOptions& options) {
  std::vector<Subject> subjects;
  for (const std::string& file : options.models) subjects.push_back(loadSubject(context, file));
  for (const std::int64_t size : options.sizes)
    subjects.push_back(makeSubject(context, static_cast<std::size_t>(size)));
  if (subjects.empty()) subjects.push_back(makeSubject(context, 1'000'000));
  std::FILE* out = context.tables();
  Json result{{"gpu", context.device().name()}, {"repeat", options.repeat}};
  for (const std::string& name : options.names) {
    const bool build = name == "build";
    fmt::print(out, "{} on {}: us, median / p99.9 of {}\n", name, context.device().name(), options.repeat);
    if (build)
      fmt::print(out, "{:<28} {:>11} {:>12} {:>20}\n", "model", "points", "first", "steady");
    else
      fmt::print(out, "{:<28} {:>11} {:>18} {:>20} {:>18} {:>20}\n", "model", "points", "static, GPU", "pose to force",
                 "edit, GPU", "pose to force, edited");
    for (const Subject& subject : subjects)
      result[name].push_back(build ? benchBuild(context, subject, options) : benchStep(context, subject, options));
    fmt::print(out, "\n");
  }
  context.writeJson(result);
}

}  // namespace

void addBench(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand("bench", "measure on this machine: build (the index), step (a haptic tick)");
  auto options = std::make_shared<BenchOptions>();
  sub->add_option("names", options->names, "build, step")
      ->required()
      ->check(CLI::IsMember({"build", "step"}))
      ->type_name("NAME...");
  sub->add_option("--models", options->models, "PLY files")->type_name("FILE...");
  sub->add_option("--sizes", options->sizes, "numbers of points; a sculpture is made for each")
      ->check(between(1, 2e9))
      ->type_name("N...");
  sub->add_option("--repeat", options->repeat, "measured repetitions")->check(between(1, 1e9))->capture_default_str();
  sub->add_option("--rate", options->rate_Hz, "ticks per second of step")->check(positive())->capture_default_str();
  sub->callback([&, options] { command = [&context, options] { bench(context, *options); }; });
}

}  // namespace palpate
