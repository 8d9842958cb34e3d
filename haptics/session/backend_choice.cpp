#include "haptics/session/backend_choice.hpp"

#include <cmath>
#include <numbers>

#include "engine/core/clock.hpp"
#include "engine/core/job_stop.hpp"
#include "haptics/session/abilities.hpp"
#include "haptics/session/tick_time.hpp"

namespace palpate {

namespace {

constexpr double kTie = 1.1;                     // the GPU's time over the CPU's
constexpr std::size_t kMaxPartPoints = 200'000;  // around the spot: enough that the hand meets no edge

std::string inWords(const BackendTime& time) {
  if (!time.failure.empty()) return "not usable: " + time.failure;
  return time.p99_us ? fmt::format("{:.0f} us", *time.p99_us) : "not measured";
}

// Largest power of ten that does not exceed `value`.
double magnitude(double value) { return std::pow(10, std::floor(std::log10(std::max(1.0, value)))); }

// The points around `place`, by distance. A tick depends on them alone, and their index is built sooner.
Model partAround(const Model& model, const DVec3& place) {
  const PointCloud& cloud = model.cloud;
  Model part{.cloud = {.origin = cloud.origin},
             .scale = model.scale,
             .spacing = model.spacing,
             .wideSpacing = model.wideSpacing,
             .noise = model.noise};
  const auto isWithin = [&](std::size_t i, double reach) {
    const DVec3 d = DVec3(cloud.positions[i]) - place;
    return glm::dot(d, d) <= reach * reach;
  };
  const auto within = [&](double reach) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) count += isWithin(i, reach);
    return count;
  };
  // As many as a flat surface has there; less where it is folded.
  double reach = model.spacing * std::sqrt(kMaxPartPoints / std::numbers::pi);
  while (within(reach) > kMaxPartPoints) reach *= 0.7;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!isWithin(i, reach)) continue;
    part.cloud.positions.push_back(cloud.positions[i]);
    part.cloud.normals.push_back(cloud.normals[i]);
    if (cloud.hasColors()) part.cloud.colors.push_back(cloud.colors[i]);
  }
  return part;
}

BackendTime timeOf(const TickTimeRequest& request) {
  try {
    return {.p99_us = tickTimes(request).front().p99, .failure = {}};
  } catch (const Stopped&) {
    throw;
  } catch (const Error& error) {
    return {.p99_us = {}, .failure = error.what()};
  }
}

BackendTimes measure(const SessionConfig& config, const Model& whole, const BackendCandidates& candidates) {
  const Stopwatch watch;
  const std::vector<SurfaceSpot> places = sculptingPlaces(whole, kCoarsePoints);
  std::optional<Model> part;
  if (whole.cloud.size() > kMaxPartPoints) part = partAround(whole, places.front().position);
  const Model& model = part ? *part : whole;
  const Stroke stroke = strokeWith(config.brush.value_or(BrushConfig{}), whole);
  const auto on = [&](const BackendKind& kind) {
    return timeOf({.kind = kind,
                   .config = config,
                   .model = model,
                   .places = places,
                   .strokes = {&stroke, 1},
                   .threads = candidates.threads});
  };
  BackendTimes times{.gpu = on(candidates.gpu), .cpu = on(candidates.cpu)};
  times.measured_s = watch.elapsed_s();
  return times;
}

// One line for all that a measurement depends on.
std::string keyOf(const SessionConfig& config, const Model& model, const BackendCandidates& candidates) {
  std::string key =
      fmt::format("{}; {}; {:.0f} points", candidates.gpu.identity(candidates.threads),
                  candidates.cpu.identity(candidates.threads), magnitude(static_cast<double>(model.cloud.size())));
  if (config.brush) {
    const double radius = model.scale.toUnits(config.brush->radius_mm) / model.spacing;
    key += fmt::format("; edits of {:.0f}", magnitude(std::numbers::pi * radius * radius));
  }
  return key;
}

bool accepts(const BackendKind& kind, const SessionConfig& config) {
  try {
    kind.check(config);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

BackendChoice soonerOf(const BackendTimes& times) {
  const BackendTime &gpu = times.gpu, &cpu = times.cpu;
  const bool takesGpu =
      !cpu.failure.empty() || (gpu.failure.empty() && gpu.p99_us && cpu.p99_us && *gpu.p99_us <= kTie * *cpu.p99_us);
  const std::string_view what = times.edits ? "a tick with an edit" : "a query";
  const std::string when = times.measured_s ? fmt::format("measured for {:.1f} s", *times.measured_s)
                                            : "measured earlier; palpate doctor --forget measures again";
  const auto sentence = [&](std::string_view name, const BackendTime& chosen, std::string_view other,
                            const BackendTime& rejected) {
    return fmt::format("Back end: {} ({}; {}: {}; p99 of {}, {})", name, inWords(chosen), other, inWords(rejected),
                       what, when);
  };
  return {.gpu = takesGpu,
          .sentence = takesGpu ? sentence(times.gpuName, gpu, "cpu", cpu) : sentence("cpu", cpu, times.gpuName, gpu)};
}

const BackendKind& soonerBackend(const SessionConfig& config, const Model& model, const BackendCandidates& candidates) {
  SessionConfig measured = config;
  if (!measured.brush) measured.brush = candidates.laterBrush;
  measured.backend.name = candidates.cpu.name();
  if (modelKindOf(config, model) != ModelKind::cloud || model.cloud.empty() || !accepts(candidates.cpu, measured))
    return candidates.gpu;
  BackendTimes times;
  try {
    candidates.gpu.requireProof();
    const std::string key = keyOf(measured, model, candidates);
    const auto known = candidates.memory.recall(key, [&](std::string_view what) { candidates.log.say("{}", what); });
    times = known ? BackendTimes{.gpu = {.p99_us = known->gpu_us}, .cpu = {.p99_us = known->cpu_us}}
                  : measure(measured, model, candidates);
    if (!known && times.gpu.p99_us && times.cpu.p99_us)
      candidates.memory.remember(key, {*times.gpu.p99_us, *times.cpu.p99_us});
    times.gpuName = candidates.gpu.machine(candidates.threads);
  } catch (const GpuError& error) {
    times.gpu.failure = error.what();
    times.gpuName = candidates.gpu.name();
  }
  times.edits = measured.brush.has_value();
  const BackendChoice choice = soonerOf(times);
  candidates.log.say("{}", choice.sentence);
  return choice.gpu ? candidates.gpu : candidates.cpu;
}

}  // namespace palpate
