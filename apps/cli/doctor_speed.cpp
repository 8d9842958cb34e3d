#include "apps/cli/doctor_speed.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/core/clock.hpp"
#include "haptics/pace_check.hpp"
#include "haptics/session/tick_time.hpp"

namespace palpate {

namespace {

constexpr double kRate_Hz = 1000, kServo_s = 0.5, kStroke_s = 0.2;
constexpr double kStart_s = 2;  // no GPU begins later, so that its measurement ends within three seconds
constexpr std::size_t kPoints = 1'000'000;
constexpr std::array<std::size_t, 2> kTouched{100, 1000};

Model sphere() {
  constexpr double kSize_mm = 100;
  const auto shape = makeShape("sphere", kSize_mm, DVec3(0));
  const double spacing = kSize_mm * std::sqrt(std::numbers::pi / kPoints);
  return {.cloud = sampleShape(*shape, {.count = kPoints}), .scale = {1}, .spacing = spacing, .wideSpacing = spacing};
}

Json servo(std::FILE* out) {
  const PaceCheck check = checkPace(kRate_Hz, kServo_s);
  const double reached_Hz = static_cast<double>(check.ticks) / kServo_s;
  fmt::print(out, "  servo loop at {:g} Hz: reaches {:.0f} Hz, {} of {} ticks missed{}\n", kRate_Hz, reached_Hz,
             check.missed, check.ticks + check.missed, check.realtimePriority ? "" : " (no real-time priority)");
  return {{"rate_Hz", kRate_Hz}, {"reached_Hz", reached_Hz}, {"missed_ticks", check.missed}};
}

struct SpeedScene {
  Model model = sphere();
  std::vector<SurfaceSpot> places = sculptingPlaces(model, kCoarsePoints);
  std::vector<Stroke> strokes{reaching(kTouched[0]), reaching(kTouched[1])};

  Stroke reaching(std::size_t touched) const {
    return strokeThatReaches(touched, BrushKind::push, model, places.front(), kRate_Hz);
  }
};

Json edits(std::FILE* out, Context& context, const std::string& backend, const SpeedScene& scene, bool hasTime) {
  Json measured{{"backend", backend}, {"edits", Json::array()}, {"reason", ""}};
  std::string machine = backend;
  try {
    if (!hasTime) throw Error("not measured: no time left");
    const BackendKind& kind = context.backends().named(backend);
    machine = kind.machine(context.threads());
    const std::vector<Summary> times = tickTimes({.kind = kind,
                                                  .config = {.brush = scene.strokes.front().brush},
                                                  .model = scene.model,
                                                  .places = scene.places,
                                                  .strokes = scene.strokes,
                                                  .threads = context.threads(),
                                                  .duration_s = kStroke_s});
    for (std::size_t i = 0; i < times.size(); ++i) {
      fmt::print(out, "  {:>16}", fmt::format("{:.0f} / {:.0f}", times[i].p50, times[i].p99));
      measured["edits"].push_back(
          {{"touched", kTouched[i]}, {"p50_us", times[i].p50}, {"p99_us", times[i].p99}, {"ticks", times[i].count}});
    }
    fmt::print(out, "   {}\n", machine);
  } catch (const Error& error) {
    measured["reason"] = error.what();
    fmt::print(out, "  {}: {}\n", machine, error.what());
  }
  measured["machine"] = machine;
  return measured;
}

}  // namespace

Json machineSpeed(std::FILE* out, Context& context) {
  const Stopwatch watch;
  fmt::print(out, "Speed of this machine:\n");
  Json result{{"servo", servo(out)}, {"points", kPoints}, {"backends", Json::array()}};
  const SpeedScene scene;
  fmt::print(out, "  a tick with an edit of {} points, median / p99, us:\n  {:>16}  {:>16}\n", kPoints,
             fmt::format("{} touched", kTouched[0]), fmt::format("{} touched", kTouched[1]));
  std::vector<std::string> names{"cpu"};
  if (context.hasRealGpu()) names.emplace_back("vulkan");
  for (const std::string& name : names)
    result["backends"].push_back(edits(out, context, name, scene, name == "cpu" || watch.elapsed_s() < kStart_s));
  result["measured_s"] = watch.elapsed_s();
  fmt::print(out, "  (measured for {:.1f} s)\n", watch.elapsed_s());
  return result;
}

}  // namespace palpate
