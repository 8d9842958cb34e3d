// Cost of a millisecond of matter that a hand stirs or presses.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "apps/bench/bench.hpp"
#include "apps/bench/matter_bytes.hpp"
#include "apps/simulation/matter_backend.hpp"
#include "engine/matter/soft_model.hpp"
#include "engine/matter/soft_scene.hpp"

namespace palpate {

namespace {

constexpr double kSpacing_mm = 5;
constexpr double kBall_spacings = 3.5;
constexpr int kWarmUpSteps = 50;  // steps: the ball is lowered, clocks rise
constexpr int kPassSteps = 20;    // steps whose passes are timed individually
constexpr int kAskedCompliances = 10;

struct MatterBenchOptions : BenchOptions {
  std::vector<std::string> matters{"water", "sand"};
  std::int64_t points = 0;   // points that a soft body carries; 0: those of its skin
  std::int64_t presses = 0;  // presses on the surface of a soft body, in place of a ball
  double depth_mm = 0;       // depth of the filling; 0: equal to its width
  bool passes = false;
};

// A tank as wide as its filling, with room above for a ball of the matter's density.
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

// A cube with about that many nodes, or a flat block for few nodes, on the floor of a larger box.
MatterScene softScene(std::size_t nodes) {
  const double side = std::max(2 * kBall_spacings + 1, std::round(std::cbrt(static_cast<double>(nodes))) - 1);
  const double layers = std::max(1.0, std::round(static_cast<double>(nodes) / ((side + 1) * (side + 1))) - 1);
  MatterScene scene = sceneOf(Matter::water, 0, 0);
  scene.matter = Matter::soft;
  scene.viscosity_Pa_s = kSoftViscosity_Pa_s;
  scene.fill_mm = DVec3(side, layers, side) * kSpacing_mm;
  scene.box_mm = scene.fill_mm + DVec3(8, 2 * kBall_spacings + 4, 8) * kSpacing_mm;
  return scene;
}

// At least `count` points on the faces of that body, in rows as from a scanner.
std::vector<SurfacePlace> pointsOn(const MatterScene& scene, std::int64_t count) {
  const auto [low, high] = standOf(scene);
  const DVec3 sides = high - low;
  const double area = 2 * (sides.x * sides.y + sides.y * sides.z + sides.z * sides.x);
  const double apart = std::sqrt(area / static_cast<double>(count));
  std::vector<SurfacePlace> points;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {0.0, 1.0}) {
      const int across = (axis + 1) % 3, along = (axis + 2) % 3;
      DVec3 normal(0), share(0);
      normal[axis] = side > 0 ? 1 : -1;
      share[axis] = side;
      const double rows = std::ceil(sides[across] / apart), columns = std::ceil(sides[along] / apart);
      for (double row = 0; row < rows; ++row)
        for (double column = 0; column < columns; ++column) {
          share[across] = (row + 0.5) / rows;
          share[along] = (column + 0.5) / columns;
          points.push_back({.rest = low + share * sides, .normal = normal});
        }
    }
  return points;
}

// Lowers the ball until half of it is immersed, or until it presses a soft body; then moves it in a circle.
HandPose stirring(const MatterScene& scene, std::int64_t step) {
  constexpr double kSpeed_m_s = 0.2, kDown_m_s = 0.4, kPressed_radii = 0.3;
  const double middle_m = scene.box_mm.x * 1e-3 / 2, far_m = std::max(scene.fill_mm.x * 1e-3 / 4, 1e-3);
  const double angle = kSpeed_m_s * kMatterStep_s * static_cast<double>(step) / far_m;
  const double radius_m = scene.tool.radius_mm * 1e-3;
  const double above_m = radius_m - kDown_m_s * kMatterStep_s * static_cast<double>(step);
  const double least_m = scene.matter == Matter::soft ? (1 - kPressed_radii) * radius_m : 0;
  return {.place_m = {middle_m + far_m * std::cos(angle), scene.fill_mm.y * 1e-3 + std::max(above_m, least_m),
                      middle_m + far_m * std::sin(angle)}};
}

// Hands side by side that press a few millimetres deep on a body, as a feeling hand does, and move in a circle.
class Pressing {
 public:
  explicit Pressing(std::int64_t count) : presses_(static_cast<std::size_t>(count)) {}

  std::span<const SurfacePress> at(const MatterScene& scene, std::int64_t step) {
    constexpr double kDeep_m = 3e-3, kApart = 0.1;  // kApart: of a full circle
    for (std::size_t i = 0; i < presses_.size(); ++i) {
      SurfacePress& press = presses_[i];
      DVec3 place = stirring(scene, step).place_m;
      const DVec3 middle = scene.box_mm * 1e-3 / 2.0, arm = place - middle;
      const double turn = 2 * std::numbers::pi * kApart * static_cast<double>(i);
      place = middle + DVec3(arm.x * std::cos(turn) - arm.z * std::sin(turn), 0,
                             arm.x * std::sin(turn) + arm.z * std::cos(turn));
      place.y = scene.fill_mm.y * 1e-3;
      press.place_m = {place.x, press.place_m.y > 0 ? press.place_m.y : place.y, place.z};
      press.handFrom_m = step > 0 ? press.handTo_m : place;
      press.handTo_m = place - DVec3(0, kDeep_m, 0);
      press.normal = {0, 1, 0};
      press.radius_m = 2 * scene.spacing_mm * 1e-3;
      press.stiffness_N_m = 500;
      press.damping_N_s_m = 2;
      press.friction = 0.3;
      press.most_N = 5;
      press.hand = static_cast<std::uint32_t>(i);
    }
    return presses_;
  }
  void heard(std::span<const PressReport> reports) {
    for (std::size_t i = 0; i < presses_.size(); ++i) presses_[i].place_m = reports[i].place_m;
  }

 private:
  std::vector<SurfacePress> presses_;
};

// A measured scene on a back end.
struct MatterCase {
  MatterScene scene;
  std::string backend;
  std::int64_t points = 0, presses = 0;
};

std::unique_ptr<MatterSimulation> start(Context& context, const MatterCase& one, bool timesPasses) {
  MatterOptions options{.threads = context.threads(), .tools = one.presses > 0 ? 0u : 1u, .timesPasses = timesPasses};
  if (one.scene.matter != Matter::soft || one.points == 0) return startMatter(context, one.backend, one.scene, options);
  return startSoft(context, one.backend, one.scene, options, solidOf(one.scene), pointsOn(one.scene, one.points));
}

// Steps with a hand, each from where the last step ended, and frames of points.
class Stirred {
 public:
  Stirred(Context& context, const MatterCase& one, bool timesPasses)
      : world_(start(context, one, timesPasses)), pressing_(one.presses), presses_(one.presses > 0) {
    for (int k = 0; k < kWarmUpSteps; ++k) step();
  }
  void step() {
    const HandPose hand = stirring(world_->scene(), steps_);
    if (presses_) world_->press(pressing_.at(world_->scene(), steps_));
    world_->step({&hand, presses_ ? 0u : 1u});
    if (presses_) pressing_.heard(world_->pressed());
    ++steps_;
    if (world_->state() != MatterState::running) throw Error("the simulation failed after {} steps", steps_);
  }
  /// Frame of a soft body, made where it is simulated.
  void frame() {
    if (!world_->makeFrameThere()) world_->makeFrame(frame_);
  }
  /// The same frame on the host.
  std::size_t fetchFrame() {
    world_->makeFrame(frame_);
    return frame_.size();
  }
  /// Queried as a session does, at the last press.
  double compliance_m_N() {
    return world_->localCompliance_m_N(world_->pressed().front().place_m, world_->scene().spacing_mm * 1e-3,
                                       {0, -1, 0});
  }
  const MatterSimulation& world() const { return *world_; }

 private:
  std::unique_ptr<MatterSimulation> world_;
  Pressing pressing_;
  bool presses_;
  CloudFrame frame_;
  std::int64_t steps_ = 0;
};

// Times on the GPU, none where it was not used, and in all.
struct Spans {
  Summary gpu_us, wall_us;
};

// Frames of the points of a soft body: made where it is simulated, and fetched to the host.
struct FrameCost {
  std::size_t points = 0;
  Spans made;
  Summary fetched_us;
};

struct MatterCost {
  std::string matter, backend;
  std::size_t particles = 0;
  double depth_mm = 0;
  std::uint32_t substeps = 0;
  Spans step, substep;
  std::int64_t presses = 0;
  std::optional<Summary> compliance_us;
  std::optional<FrameCost> frame;
  std::map<std::string, PassBytes> passes_bytes;  // that each working pass moves
  std::map<std::string, Summary> passes_us;
};

// By pass, each time that it ran, us.
std::map<std::string, Summary> passTimes(Context& context, const MatterCase& one) {
  Stirred stirred(context, one, true);
  std::map<std::string, std::vector<double>> times;
  for (int k = 0; k < kPassSteps; ++k) {
    stirred.step();
    if (one.scene.matter == Matter::soft) stirred.frame();
    for (const PassRecord& pass : stirred.world().passes())
      if (pass.gpu_us > 0) times[pass.name].push_back(pass.gpu_us);
  }
  std::map<std::string, Summary> passes;
  for (const auto& [name, all] : times) passes.emplace(name, summarize(all));
  return passes;
}

// All times divided by the number of substeps.
std::vector<double> eachOf(std::vector<double> times, std::uint32_t substeps) {
  for (double& time : times) time /= substeps;
  return times;
}

// Each frame after a step of its own.
FrameCost frameCost(const MatterBenchOptions& options, Stirred& stirred) {
  std::vector<double> gpu_us, wall_us, fetched_us;
  repeatMeasurement(options, [&](std::int64_t) {
    stirred.step();
    const Stopwatch watch;
    stirred.frame();
    wall_us.push_back(watch.elapsed_us());
    if (const auto time_us = stirred.world().frameTime_us()) gpu_us.push_back(*time_us);
  });
  std::size_t points = 0;
  repeatMeasurement(options, [&](std::int64_t) {
    stirred.step();
    const Stopwatch watch;
    points = stirred.fetchFrame();
    fetched_us.push_back(watch.elapsed_us());
  });
  return {.points = points, .made = {summarize(gpu_us), summarize(wall_us)}, .fetched_us = summarize(fetched_us)};
}

// Time of a compliance query at a pressed surface.
Summary complianceTimes_us(Stirred& stirred) {
  std::vector<double> wall_us;
  for (int k = 0; k < kAskedCompliances; ++k) {
    stirred.step();
    const Stopwatch watch;
    if (!(stirred.compliance_m_N() > 0)) throw Error("the surface does not yield to a force");
    wall_us.push_back(watch.elapsed_us());
  }
  return summarize(wall_us);
}

MatterCost measure(Context& context, const MatterCase& one, const MatterBenchOptions& options) {
  Stirred stirred(context, one, false);
  std::vector<double> gpu_us, wall_us;
  repeatMeasurement(options, [&](std::int64_t) {
    const Stopwatch watch;
    stirred.step();
    wall_us.push_back(watch.elapsed_us());
    if (const auto time_us = stirred.world().gpuTime_us()) gpu_us.push_back(*time_us);
  });
  const std::uint32_t substeps = stirred.world().plan().substeps;
  MatterCost cost{.matter = std::string(nameOf(kMatters, one.scene.matter)),
                  .backend = one.backend,
                  .particles = stirred.world().particles(),
                  .depth_mm = one.scene.fill_mm.y,
                  .substeps = substeps,
                  .step = {summarize(gpu_us), summarize(wall_us)},
                  .substep = {summarize(eachOf(gpu_us, substeps)), summarize(eachOf(wall_us, substeps))},
                  .presses = one.presses,
                  .compliance_us = {},
                  .frame = {},
                  .passes_bytes = {},
                  .passes_us = {}};
  if (one.presses > 0) cost.compliance_us = complianceTimes_us(stirred);
  if (one.scene.matter == Matter::soft) cost.frame = frameCost(options, stirred);
  if (options.passes) {
    if (one.backend == "vulkan" && one.scene.matter != Matter::soft)  // the bytes of other passes are not counted
      cost.passes_bytes = matterBytes(one.scene, cost.particles);
    cost.passes_us = passTimes(context, one);
  }
  return cost;
}

using Value = std::optional<Json>;

constexpr Reported<FrameCost> kFrame[]{
    {"points", "", "its points", field<&FrameCost::points>},
    {"gpu_us", "us", "time on the GPU to make it; null: not measured",
     [](const FrameCost& f) -> Value { return summaryOf(f.made.gpu_us); }},
    {"wall_us", "us", "the same in all", [](const FrameCost& f) -> Value { return summaryOf(f.made.wall_us); }},
    {"fetched_us", "us", "time until it is on the host", quantiles<&FrameCost::fetched_us>},
};

constexpr Reported<PassBytes> kPassBytes[]{{"moved", "B", "moved bytes", field<&PassBytes::moved>},
                                           {"asked", "B", "requested bytes", field<&PassBytes::asked>},
                                           {"early_exit", "", "returns early", field<&PassBytes::earlyExit>}};

constexpr Reported<MatterCost> kMatterBench[]{
    {"matter", "", "water, sand or soft", field<&MatterCost::matter>},
    {"backend", "", "back end", field<&MatterCost::backend>},
    {"particles", "", "particles, or nodes of a soft body", field<&MatterCost::particles>},
    {"depth_mm", "mm", "depth of the filling", field<&MatterCost::depth_mm>},
    {"substeps", "", "substeps per millisecond", field<&MatterCost::substeps>},
    {"step.gpu_us", "us", "time of a millisecond on the GPU; null: not measured",
     [](const MatterCost& c) -> Value { return summaryOf(c.step.gpu_us); }},
    {"step.wall_us", "us", "time of a millisecond in all",
     [](const MatterCost& c) -> Value { return summaryOf(c.step.wall_us); }},
    {"substep.gpu_us", "us", "the same for a substep; null: not measured",
     [](const MatterCost& c) -> Value { return summaryOf(c.substep.gpu_us); }},
    {"substep.wall_us", "us", "the same for a substep",
     [](const MatterCost& c) -> Value { return summaryOf(c.substep.wall_us); }},
    {"presses", "", "hands that press (--presses)", field<&MatterCost::presses>},
    {"compliance", "us", "time of a compliance query: wall_us; null: nothing presses",
     [](const MatterCost& c) -> Value {
       return c.compliance_us ? Json{{"wall_us", summaryOf(*c.compliance_us)}} : Json(nullptr);
     }},
    {"frame", "us", "a frame of a soft body; else null",
     [](const MatterCost& c) -> Value { return orNull(partBy(kFrame, c.frame)); }},
    {"passes_bytes", "B", "bytes that each pass moved and requested (--passes)",
     [](const MatterCost& c) -> Value {
       Json passes = Json::object();
       for (const auto& [name, bytes] : c.passes_bytes) passes[name] = jsonBy(kPassBytes, bytes);
       return passes;
     }},
    {"passes_us", "us", "time of each pass (--passes)",
     [](const MatterCost& c) -> Value {
       Json passes = Json::object();
       for (const auto& [name, us] : c.passes_us) passes[name] = summaryOf(us);
       return passes;
     }},
};

Json benchMatter(Context& context, const MatterBenchOptions& options) {
  std::vector<std::int64_t> sizes = options.sizes;
  if (sizes.empty()) sizes.push_back(100'000);
  std::vector<MatterCost> costs;
  for (const std::string& name : options.matters)
    for (const std::int64_t size : sizes)
      for (const std::string& backend : options.backends) {
        context.log().say("matter: {} particles of {}, {}", size, name, backend);
        const Matter matter = *valueNamed(kMatters, name);
        if (options.presses > 0 && matter != Matter::soft)
          throw UsageError("--presses requires --matter soft: only a soft body has a surface");
        const auto particles = static_cast<std::size_t>(size);
        const MatterScene scene =
            matter == Matter::soft ? softScene(particles) : sceneOf(matter, particles, options.depth_mm);
        warmUp(context, options);
        costs.push_back(
            measure(context, {.scene = scene, .backend = backend, .points = options.points, .presses = options.presses},
                    options));
      }
  Json json = arrayBy(kMatterBench, costs);
  printTables(context.tables(), "matter", json);
  return json;
}

}  // namespace

void listMatterBenchResults(std::vector<ResultFacts>& all) {
  constexpr DescribedKey records[]{{"", "", "one for each matter, size and back end"}};
  listAlone(all, "matter", "", records);
  listAlone(all, "matter", "[].", kMatterBench);
  listAlone(all, "matter", "[].frame.", kFrame);
}

void addMatterBench(Options& bench, Context& context, Command& command) {
  Options& sub =
      bench.addSubcommand("matter", "a millisecond of water, sand or a soft body that a hand stirs or presses");
  const auto options = std::make_shared<MatterBenchOptions>();
  sub.add("--sizes", options->sizes,
          "approximate numbers of particles or nodes; each fills a tank or makes a cube (default: 100000)")
      .check(wholeBetween(1, 1e8))
      .typeName("N...");
  sub.add("--matter", options->matters, "matter to stir, or to press if soft: water, sand, soft")
      .check(oneOf(namesOf(kMatters)))
      .separatedBy(',')
      .showDefault();
  sub.add("--points", options->points,
          "approximate number of points that a soft body carries; 0: one per half spacing of its skin")
      .check(wholeBetween(0, 1e8))
      .showDefault();
  sub.add("--presses", options->presses,
          "hands that press on a soft body's surface as in a session, in place of the ball")
      .check(wholeBetween(0, 72))
      .showDefault();
  sub.add("--depth", options->depth_mm,
          "depth of water and sand, mm, which sets the number of substeps (default: equal to the width)")
      .check(between(10, 1e5))
      .typeName("MM");
  addBackendsOption(sub, *options, matterBackends());
  sub.addFlag("--passes", options->passes, "also time each pass alone, in further steps");
  addRepeatOptions(sub, *options);
  sub.footer(
      "Time of a step of a millisecond, and per substep, on the GPU's clock including the host's work, while a ball "
      "moves through the matter, or is dragged over a soft body. For a soft body also a frame of the points that it "
      "carries, on the GPU and until they are on the host; and with presses the time of a compliance query.\n");
  sub.whenNamed([&, options] { command = measuringAlone(context, options, "matter", benchMatter); });
}

}  // namespace palpate
