// What a millisecond of matter costs that a hand stirs.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "apps/bench/bench.hpp"
#include "apps/cli/matter_backend.hpp"

namespace palpate {

namespace {

constexpr double kSpacing_mm = 5;
constexpr double kBall_spacings = 3.5;
constexpr int kWarmUp = 50;     // steps: the ball comes down, clocks rise
constexpr int kPassSteps = 20;  // in which passes are timed one by one

struct MatterBenchOptions : BenchOptions {
  std::vector<std::string> matters{"water", "sand"};
  double depth_mm = 0;  // of what fills the tank; 0: as deep as wide
  bool passes = false;
};

// A tank as wide as it is filled, with room for a ball above that weighs what it displaces.
MatterScene sceneOf(Matter matter, std::size_t particles, double depth_mm) {
  const auto count = static_cast<double>(particles);
  const double wanted = depth_mm > 0 ? std::sqrt(count * kSpacing_mm / depth_mm) : std::cbrt(count);
  const double side = std::max(2 * kBall_spacings + 1, std::round(wanted));
  const double layers = std::max(1.0, std::round(static_cast<double>(particles) / (side * side)));
  const double radius_m = kBall_spacings * kSpacing_mm * 1e-3, density_kg_m3 = matter == Matter::sand ? 1600 : 1000;
  MatterScene scene{.matter = matter,
                    .box_mm = DVec3(side, layers + 2 * kBall_spacings + 4, side) * kSpacing_mm,
                    .fill_mm = DVec3(side, layers, side) * kSpacing_mm,
                    .spacing_mm = kSpacing_mm,
                    .density_kg_m3 = density_kg_m3};
  scene.tool = {.radius_mm = radius_m * 1e3,
                .mass_kg = density_kg_m3 * 4 / 3 * std::numbers::pi * radius_m * radius_m * radius_m};
  return scene;
}

// Comes down from above until the ball is half in, and goes around there.
HandPose stirring(const MatterScene& scene, std::int64_t step) {
  constexpr double kSpeed_m_s = 0.2, kDown_m_s = 0.4;
  const double around_m = scene.fill_mm.x * 1e-3 / 2, far_m = std::max(around_m / 2, 1e-3);
  const double angle = kSpeed_m_s * kMatterStep_s * static_cast<double>(step) / far_m;
  const double above_m = scene.tool.radius_mm * 1e-3 - kDown_m_s * kMatterStep_s * static_cast<double>(step);
  return {.place_m = {around_m + far_m * std::cos(angle), scene.fill_mm.y * 1e-3 + std::max(above_m, 0.0),
                      around_m + far_m * std::sin(angle)}};
}

// Steps with a hand, from where the last one ended.
class Stirred {
 public:
  Stirred(Context& context, const std::string& backend, const MatterScene& scene, bool timesPasses)
      : world_(startMatter(context, backend, scene, {.tools = 1, .timesPasses = timesPasses})) {
    for (int k = 0; k < kWarmUp; ++k) step();
  }
  void step() {
    const HandPose hand = stirring(world_->scene(), steps_++);
    world_->step({&hand, 1});
    if (world_->state() != MatterState::running) throw Error("the simulation failed after {} steps", steps_);
  }
  const MatterSimulation& world() const { return *world_; }

 private:
  std::unique_ptr<MatterSimulation> world_;
  std::int64_t steps_ = 0;
};

// By pass, each time that it ran, us.
Json passTimes(Context& context, const std::string& backend, const MatterScene& scene) {
  Stirred stirred(context, backend, scene, true);
  std::map<std::string, std::vector<double>> times;
  for (int k = 0; k < kPassSteps; ++k) {
    stirred.step();
    for (const PassRecord& pass : stirred.world().passes())
      if (pass.gpu_us > 0) times[pass.name].push_back(pass.gpu_us);
  }
  Json passes = Json::object();
  for (const auto& [name, all] : times) passes[name] = summaryOf(summarize(all));
  return passes;
}

// All times over the substeps that they are of.
std::vector<double> eachOf(std::vector<double> times, std::uint32_t substeps) {
  for (double& time : times) time /= substeps;
  return times;
}

Json measure(Context& context, Matter matter, std::size_t particles, const std::string& backend,
             const MatterBenchOptions& options) {
  const MatterScene scene = sceneOf(matter, particles, options.depth_mm);
  Stirred stirred(context, backend, scene, false);
  std::vector<double> gpu_us, wall_us;
  repeatMeasurement(options, [&](std::int64_t) {
    const Stopwatch watch;
    stirred.step();
    wall_us.push_back(watch.elapsed_us());
    if (const auto time_us = stirred.world().gpuTime_us()) gpu_us.push_back(*time_us);
  });
  const std::uint32_t substeps = stirred.world().plan().substeps;
  return {{"matter", nameOf(kMatters, matter)},
          {"backend", backend},
          {"particles", stirred.world().particles()},
          {"depth_mm", scene.fill_mm.y},
          {"substeps", substeps},
          {"step", {{"gpu_us", summaryOf(summarize(gpu_us))}, {"wall_us", summaryOf(summarize(wall_us))}}},
          {"substep",
           {{"gpu_us", summaryOf(summarize(eachOf(gpu_us, substeps)))},
            {"wall_us", summaryOf(summarize(eachOf(wall_us, substeps)))}}},
          {"passes_us", options.passes ? passTimes(context, backend, scene) : Json::object()}};
}

std::string said(const Json& summary) {
  return summary.is_null()
             ? "–"
             : fmt::format("{:.1f} / {:.1f}", summary["p50"].get<double>(), summary["p999"].get<double>());
}

void print(std::FILE* out, const Json& records) {
  fmt::print(out, "\nmatter that a ball stirs: us, median / p99.9\n{:<8}{:<9}{:>11}{:>11}{:>10}", "", "", "particles",
             "depth, mm", "substeps");
  for (const char* column : {"step, on the GPU", "in all", "substep, on the GPU", "in all"})
    fmt::print(out, "{:>24}", column);
  fmt::print(out, "\n");
  for (const Json& record : records) {
    fmt::print(out, "{:<8}{:<9}{:>11}{:>11.0f}{:>10}", record["matter"].get<std::string>(), record["backend"].get<std::string>(),
               record["particles"].get<std::size_t>(), record["depth_mm"].get<double>(),
               record["substeps"].get<std::size_t>());
    for (const char* span : {"step", "substep"})
      for (const char* clock : {"gpu_us", "wall_us"}) fmt::print(out, "{:>24}", said(record[span][clock]));
    fmt::print(out, "\n");
    for (const auto& [name, times] : record["passes_us"].items())
      fmt::print(out, "  {:<24}{:>24}\n", name, said(times));
  }
}

Json benchMatter(Context& context, const MatterBenchOptions& options) {
  std::vector<std::int64_t> sizes = options.sizes;
  if (sizes.empty()) sizes.push_back(100'000);
  Json records = Json::array();
  for (const std::string& name : options.matters)
    for (const std::int64_t size : sizes)
      for (const std::string& backend : options.backends) {
        context.log().say("matter: {} particles of {}, {}", size, name, backend);
        records.push_back(
            measure(context, *valueNamed(kMatters, name), static_cast<std::size_t>(size), backend, options));
      }
  print(context.tables(), records);
  return records;
}

}  // namespace

void addMatterBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("matter", "a millisecond of water or sand that a hand stirs");
  const auto options = std::make_shared<MatterBenchOptions>();
  sub.add("--sizes", options->sizes, "numbers of particles, about; a tank is filled for each (default 100000)")
      .check(wholeBetween(1, 1e8))
      .typeName("N...");
  addListOption(sub, "--matter", options->matters, "what is stirred");
  sub.add("--depth", options->depth_mm, "how deep it lies, and so how many substeps it needs (default: as deep as wide)")
      .check(between(10, 1e5))
      .typeName("MM");
  addBackendsOption(sub, *options, matterBackends());
  sub.addFlag("--passes", options->passes, "time each pass by itself, too, in further steps");
  addRepeatOptions(sub, *options);
  sub.footer(
      "Time of a step of a millisecond and its share for each substep, on the GPU's clock and with all that the host "
      "does, while a ball goes through the matter.\n");
  sub.whenNamed([&, options] {
    command = [&context, options] {
      measureAlone(context, *options, "matter", [&] { return benchMatter(context, *options); });
    };
  });
}

}  // namespace palpate
