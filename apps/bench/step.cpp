#include <algorithm>
#include <thread>

#include "apps/bench/times.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "engine/study/dynamic_tree.hpp"
#include "haptics/builtin_path.hpp"

namespace palpate {

namespace {

struct StepTimes {
  Summary gpu_us, wall_us, edit_us;
};

// Moves along `approach`, then queries at its end repeatedly, at most `rate_Hz` times a second: a busy GPU answers
// sooner than an idle one.
StepTimes measureAt(TouchBackend& backend, const std::vector<DVec3>& approach, const BenchOptions& options) {
  const bool isEdited = backend.report().scope.edits;
  // As in real time, where a question that waits is rehearsed; an edit is measured whole, as in virtual time.
  constexpr double kAmple_us = 1e6;
  const double budget_us = isEdited ? 0 : kAmple_us;
  double time_s = 0;
  const auto ask = [&](const DVec3& hip) {
    const Pose pose{.time_s = time_s += 1e-3, .hip = hip};
    const Contact contact = backend.ask({&pose, 1}, budget_us).front();
    if (!contact.valid) backend.finish();  // throws the back end's failure
    return contact;
  };
  for (const DVec3& hip : approach) {
    ask(hip);
    backend.endTick();
  }
  std::vector<double> gpu, wall;
  const Stopwatch session;
  repeatMeasurement(options, [&](std::int64_t i) {
    while (session.elapsed_s() < static_cast<double>(i) / options.rate_Hz) std::this_thread::yield();
    const Stopwatch watch;
    const Contact contact = ask(approach.back());
    if (isEdited) backend.endTick();  // starts the edit
    wall.push_back(watch.elapsed_us());
    backend.endTick();
    if (contact.gpu_us > 0) gpu.push_back(contact.gpu_us);
  });
  backend.finish();
  // One edit for each measured tick; earlier ones belong to the approach.
  const auto& edits = backend.report().editTimes_us;
  const auto measured = static_cast<std::ptrdiff_t>(std::min(wall.size(), edits.size()));
  return {summarize(gpu), summarize(wall), summarize({edits.end() - measured, edits.end()})};
}

// A press that ends in contact, tick by tick.
std::vector<DVec3> pressOn(const Model& model) {
  const Path path = builtinPath("press", model.cloud, model.scale);
  std::vector<DVec3> hips;
  for (double t_s = 0; t_s < path.duration_s(); t_s += 1e-3) hips.push_back(path.at(t_s));
  hips.push_back(path.at(path.duration_s()));
  return hips;
}

// Half a support radius above the surface, where a query is one gather and one surface.
DVec3 placeAbove(const Model& model, double radius) {
  const auto press = pressOn(model);
  const DVec3 outward = glm::normalize(press.front() - press.back());
  const std::size_t nearest = [&] {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < model.cloud.size(); ++i) {
      const DVec3 d = model.cloud.fileCoordinates(i) - press.back();
      const double aside = glm::length(d - glm::dot(d, outward) * outward) - 0.1 * glm::dot(d, outward);
      if (aside < least) {
        least = aside;
        best = i;
      }
    }
    return best;
  }();
  return model.cloud.fileCoordinates(nearest) + 0.5 * radius * DVec3(model.cloud.normals[nearest]);
}

std::vector<std::string> methodsOf(const Context& context, const std::string& backend,
                                   const TimeBenchOptions& options) {
  std::vector<std::string> methods = methodChoices(context, backend);
  if (!options.methods.empty())
    std::erase_if(methods, [&](const std::string& method) {
      return std::ranges::find(options.methods, method) == options.methods.end();
    });
  return methods;
}

// Calls `measure` for every selected method and surface of every selected back end.
template <class Measure>
void forEachMethod(const Context& context, const TimeBenchOptions& options, Measure&& measure) {
  for (const std::string& backend : options.backends)
    for (const std::string& method : methodsOf(context, backend, options))
      for (const std::string& surface : options.surfaces) {
        BenchBackend one = options.backend;
        one.backend = backend;
        one.method = method;
        one.surface = surface;
        measure(one);
      }
}

// `way` itself, and `way` with each selected tool, its face along `down`.
std::vector<BenchBackend> withTools(const BenchBackend& way, const TouchCapabilities& can,
                                    const TimeBenchOptions& options, const DVec3& down) {
  std::vector<BenchBackend> ways{way};
  if (!can.manyPoints || (!can.methodOfMany.empty() && way.method != can.methodOfMany)) return ways;
  for (const std::int64_t points : options.toolPoints) {
    BenchBackend one = way;
    one.tool = options.tool;
    one.toolPoints = static_cast<std::size_t>(points);
    one.toolSize_mm = options.toolSize_mm;
    one.toolAxis = fmt::format("{},{},{}", down.x, down.y, down.z);
    ways.push_back(one);
  }
  return ways;
}

std::string nameOf(const BackendOptions& way) {
  std::string name = way.method;
  if (!way.surface.empty() && way.surface != "average") name += " " + way.surface;
  if (way.toolPoints > 0) name += fmt::format(", {} of {}", way.tool, way.toolPoints);
  return name;
}

BenchRecord recordOf(const char* bench, const BackendOptions& way, const char* input, const Subject& subject) {
  return {.bench = bench,
          .backend = way.backend,
          .way = nameOf(way),
          .input = input,
          .subject = subject.name,
          .points = subject.model.cloud.size(),
          .gpu_us = {},
          .wall_us = {}};
}

}  // namespace

void benchQuery(Context& context, const Subject& subject, const TimeBenchOptions& options,
                std::vector<BenchRecord>& records) {
  const double radius = surfaceOptions(context, subject.model, options.backend).radius;
  const DVec3 hip = placeAbove(subject.model, radius);
  forEachMethod(context, options, [&](const BenchBackend& way) {
    Session session = startSession(context, subject.model, way);
    const StepTimes times = measureAt(session.backend(), {hip}, options);
    records.push_back(recordOf("query", way, "at rest", subject));
    records.back().gpu_us = times.gpu_us;
    records.back().wall_us = times.wall_us;
  });
  if (!options.wants("cpu")) return;
  // The neighbour search alone, for structures that compute no surface: the peers of the grid.
  const HashGrid grid = gridFor(context, subject.model, options.backend);
  MultimapHash multimap(grid);
  SortedGrid sorted(grid, context.threads());
  PointTree tree;
  DynamicTree dynamic;
  const auto measure = [&](auto& search) {
    search.build(subject.model.cloud.positions);
    std::vector<double> times;
    std::vector<std::uint32_t> found;
    repeatMeasurement(options, [&](std::int64_t) {
      found.clear();
      const Stopwatch watch;
      search.near(hip - subject.model.cloud.origin, radius, found);
      times.push_back(watch.elapsed_us());
    });
    records.push_back(
        recordOf("query", {.backend = "cpu", .method = std::string(search.name())}, "neighbours alone", subject));
    records.back().wall_us = summarize(times);
  };
  measure(multimap);
  measure(sorted);
  measure(tree);
  measure(dynamic);
}

void benchStep(Context& context, const Subject& subject, const TimeBenchOptions& options,
               std::vector<BenchRecord>& records) {
  const Model& model = subject.model;
  const auto press = pressOn(model);
  forEachMethod(context, options, [&](const BenchBackend& way) {
    const TouchCapabilities can = context.backends().named(way.backend).capabilities();
    for (const BenchBackend& one : withTools(way, can, options, press.back() - press.front())) {
      Session still = startSession(context, model, one);
      const StepTimes times = measureAt(still.backend(), press, options);
      records.push_back(recordOf("step", one, "static", subject));
      records.back().gpu_us = times.gpu_us;
      records.back().wall_us = times.wall_us;
    }
  });
  const BrushConfig push{.yieldDepth_mm = 0.1, .pushRate = 1e-4, .radius_mm = 6};
  forEachMethod(context, options, [&](const BenchBackend& way) {
    Session edited = startSession(context, model, way, {.brush = push});
    const StepTimes times = measureAt(edited.backend(), press, options);
    records.push_back(recordOf("step", way, "edited", subject));
    records.back().gpu_us = times.gpu_us;
    records.back().wall_us = times.wall_us;
    records.push_back(recordOf("step", way, "the edit in it", subject));
    (way.backend == "cpu" ? records.back().wall_us : records.back().gpu_us) = times.edit_us;
  });
}

}  // namespace palpate
