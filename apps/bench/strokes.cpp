#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>

#include "apps/bench/stroke_plan.hpp"
#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxAirTicks = 400, kQuietTicks = 24, kSavedWorst = 20;

struct StrokesOptions : BenchOptions {
  std::int64_t strokes = 500, only = -1;
  std::string seed = "1", saveWorst, hand = "path";
  std::vector<std::string> brushes{"push", "carve", "inflate", "smooth", "flatten", "grab"};
};

std::uint64_t numberIn(const std::string& hex) {
  std::uint64_t number = 0;
  const char* begin = hex.data() + (hex.starts_with("0x") ? 2 : 0);
  const char* end = hex.data() + hex.size();
  const auto [at, fault] = std::from_chars(begin, end, number, 16);
  if (fault != std::errc() || at != end) throw UsageError("--seed: {} is not a hexadecimal number", hex);
  return number;
}

void save(const std::filesystem::path& folder, const StrokeModel& subject, std::span<const PointState> after,
          const PlannedStroke& plan) {
  std::filesystem::create_directories(folder);
  const std::string stem =
      fmt::format("{:04}_{}_{}_{}", plan.result.number, plan.result.subject, plan.result.brush, plan.result.place);
  const auto file = [&](std::string_view end) { return folder / (stem + std::string(end)); };
  writeCloud(file("_before.ply"), subject.model().cloud);
  writeCloud(file("_after.ply"), editedCloud(subject.model().cloud, after));
  const auto write = [&](std::string_view end, const std::string& text) {
    AtomicFile out(file(end));
    out.write(text);
    out.commit();
  };
  std::string path = "t_s,x,y,z\n";
  for (std::size_t k = 0; k < plan.hips.size(); ++k) {
    const DVec3 hip = subject.model().cloud.origin + plan.hips[k];
    path += fmt::format("{:.3f},{:.9g},{:.9g},{:.9g}\n", static_cast<double>(k) / kHandRate_Hz, hip.x, hip.y, hip.z);
  }
  write("_path.csv", path);
  const DVec3 look = plan.played.spots.front(), normal = plan.played.normals.front();
  write("_place.txt",
        fmt::format("{} {} {} {} {} {} {} {} {} {} {}\n", look.x, look.y, look.z, normal.x, normal.y, normal.z,
                    subject.model().scale.mm_per_unit, plan.result.config.radius_mm, plan.result.depth_mm,
                    plan.result.drag_mm, fmt::join(plan.result.verdict.broken(), ",")));
}

// Plays a path in virtual time, as the hand of a session.
std::vector<PointState> playPath(Context& context, const StrokeModel& subject, const BenchBackend& way,
                                 const PlannedStroke& plan) {
  Session session = startSession(context, subject.model(), way,
                                 {.brush = plan.result.config, .rate_Hz = kHandRate_Hz, .keepsPoints = true});
  session.pull({});
  const DVec3 origin = subject.model().cloud.origin;
  std::uint64_t ticks = 0;
  const auto tick = [&](const DVec3& hip) {
    const Pose pose{.time_s = static_cast<double>(ticks++) / kHandRate_Hz, .hip = origin + hip};
    const std::span<const PulledTick> answer = session.tick(std::span(&pose, 1));
    if (!answer.front().contact.valid) session.finish();  // throws the back end's failure
  };
  for (const DVec3& hip : plan.hips) tick(hip);
  for (std::size_t k = 0, quiet = 0; k < kMaxAirTicks && quiet < kQuietTicks; ++k) {
    tick(plan.hips.back());
    quiet = session.lastEdits().points.empty() ? quiet + 1 : 0;
  }
  session.endPulling();
  session.finish();
  const auto after = session.history()->points();
  return {after.begin(), after.end()};
}

void play(Context& context, StrokeModel& subject, const StrokesOptions& options, PlannedStroke& plan,
          const std::string& saveTo) {
  BenchBackend way = options.backend;
  way.backend = options.backends.front();
  const Stopwatch watch;
  std::vector<PointState> after;
  if (plan.drag) {
    SessionConfig config = configOn(subject.model(), way);
    config.model.file = subject.name();
    config.brush = plan.result.config;
    after = playDrag(config, subject.model(),
                     {.backend = context.backends().named(way.backend), .threads = context.threads()}, *plan.drag,
                     plan.hips);
    plan.result.ticks = plan.hips.size();
  } else {
    after = playPath(context, subject, way, plan);
  }
  plan.result.wall_s = watch.elapsed_s();
  plan.result.verdict = subject.judge().judge(after, plan.played);
  if (!saveTo.empty()) save(saveTo, subject, after, plan);
}

using Value = std::optional<Json>;

constexpr Reported<StrokeResult> kStrokeRows[]{
    {"number", "", "stroke number, for --only", field<&StrokeResult::number>},
    {"subject", "", "model", field<&StrokeResult::subject>},
    {"brush", "", "brush", field<&StrokeResult::brush>},
    {"place", "", "flat, edge, thin, fold or border", field<&StrokeResult::place>},
    {"radius_mm", "mm", "radius of the brush", [](const StrokeResult& r) -> Value { return r.config.radius_mm; }},
    {"depth_mm", "mm", "depth of the HIP under the surface before", field<&StrokeResult::depth_mm>},
    {"speed_mm_per_s", "mm/s", "speed of the hand", field<&StrokeResult::speed_mm_per_s>},
    {"drag_mm", "mm", "path length along the surface", field<&StrokeResult::drag_mm>},
    {"thickness_mm", "mm", "of the solid under the start; null: no far side within a brush's diameter",
     [](const StrokeResult& r) -> Value { return r.thickness_mm < kNoSide ? Json(r.thickness_mm) : Json(nullptr); }},
    {"ticks", "", "ticks of the stroke", field<&StrokeResult::ticks>},
    {"wall_s", "s", "wall time of the stroke", field<&StrokeResult::wall_s>},
    {"changed", "", "points that moved, are new or were removed",
     [](const StrokeResult& r) -> Value { return r.verdict.changed; }},
    {"inserted", "", "points inserted", [](const StrokeResult& r) -> Value { return r.verdict.inserted; }},
    {"removed", "", "points removed", [](const StrokeResult& r) -> Value { return r.verdict.removed; }},
    {"region", "", "points near changed ones after the stroke",
     [](const StrokeResult& r) -> Value { return r.verdict.region; }},
    {"region_before", "", "the same before", [](const StrokeResult& r) -> Value { return r.verdict.regionBefore; }},
    {"needed", "", "points that the region may need", [](const StrokeResult& r) -> Value { return r.verdict.needed; }},
    {"raised_mm", "mm", "largest height of a changed point above the surface before",
     [](const StrokeResult& r) -> Value { return r.verdict.raised_mm; }},
    {"raised_points", "", "points that are higher than they may be",
     [](const StrokeResult& r) -> Value { return r.verdict.raisedPoints; }},
    {"through", "", "of these, points above a side that faced away from theirs",
     [](const StrokeResult& r) -> Value { return r.verdict.through; }},
    {"turned", "", "normals against the side to which the surface has carried them",
     [](const StrokeResult& r) -> Value { return r.verdict.turned; }},
    {"shreds", "", "points with fewer than three neighbours, or off the plane of their neighbours",
     [](const StrokeResult& r) -> Value { return r.verdict.shreds; }},
    {"shreds_before", "", "the same before", [](const StrokeResult& r) -> Value { return r.verdict.shredsBefore; }},
    {"deepest_mm", "mm", "largest motion inwards", [](const StrokeResult& r) -> Value { return r.verdict.deepest_mm; }},
    {"expected_mm", "mm", "depth less the yield depth",
     [](const StrokeResult& r) -> Value { return r.verdict.expected_mm; }},
    {"far_moved_mm", "mm", "largest motion of a point that faced away from the tool",
     [](const StrokeResult& r) -> Value { return r.verdict.farMoved_mm; }},
    {"pairs", "", "pairs of neighbours before", [](const StrokeResult& r) -> Value { return r.verdict.pairs; }},
    {"folded", "", "of these, pairs that have passed each other",
     [](const StrokeResult& r) -> Value { return r.verdict.folded; }},
    {"broken", "", "criteria that the stroke fails", [](const StrokeResult& r) -> Value { return r.verdict.broken(); }},
};

struct StrokesResults {
  std::vector<StrokeResult> strokes;
  std::size_t broken() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(strokes, [](const StrokeResult& s) { return !s.verdict.broken().empty(); }));
  }
};

constexpr Reported<StrokesResults> kStrokesRows[]{
    {"strokes", "", "one for each stroke",
     [](const StrokesResults& r) -> Value { return arrayBy(kStrokeRows, r.strokes); }},
    {"broken", "", "strokes that fail a criterion", [](const StrokesResults& r) -> Value { return r.broken(); }},
};

void printTable(std::FILE* out, const std::vector<StrokeResult>& strokes) {
  std::map<std::pair<std::string, std::string>, std::vector<const StrokeResult*>> rows;
  for (const StrokeResult& stroke : strokes) {
    rows[{stroke.brush, stroke.place}].push_back(&stroke);
    rows[{stroke.brush, "~ all"}].push_back(&stroke);
    rows[{"~ all", stroke.place}].push_back(&stroke);
    rows[{"~ all", "~ all"}].push_back(&stroke);
  }
  fmt::print(out, "\nstrokes that fail a criterion, by brush and kind of place\n{:<9}{:<8}{:>10}", "brush", "place",
             "broken");
  for (const std::string_view name : strokeCriteria()) fmt::print(out, "{:>10}", name);
  fmt::print(out, "{:>9}{:>9}\n", "mean s", "most s");
  for (const auto& [key, group] : rows) {
    std::size_t broken = 0;
    double sum_s = 0, most_s = 0;
    std::map<std::string_view, std::size_t> fails;
    for (const StrokeResult* stroke : group) {
      const auto names = stroke->verdict.broken();
      broken += !names.empty();
      for (const std::string_view name : names) ++fails[name];
      sum_s += stroke->wall_s, most_s = std::max(most_s, stroke->wall_s);
    }
    fmt::print(out, "{:<9}{:<8}{:>10}", key.first, key.second, fmt::format("{}/{}", broken, group.size()));
    for (const std::string_view name : strokeCriteria()) fmt::print(out, "{:>10}", fails[name]);
    fmt::print(out, "{:>9.2f}{:>9.2f}\n", sum_s / static_cast<double>(group.size()), most_s);
  }
}

void printStroke(std::FILE* out, const StrokeResult& r) {
  const StrokeVerdict& v = r.verdict;
  fmt::print(out,
             "{:>5} {:<16}{:<8}{:<7} r {:>4.1f} depth {:>4.1f} drag {:>4.0f} {:>4.0f} mm/s  thick {:>5.1f}  points "
             "{:>6} to {:>6} high {:>5.2f} deep {:>5.2f} turned {} shreds {}-{} far {:.2f} fold {}/{} {:.1f} s  {}\n",
             r.number, r.subject, r.brush, r.place, r.config.radius_mm, r.depth_mm, r.drag_mm, r.speed_mm_per_s,
             r.thickness_mm, v.regionBefore, v.region, v.raised_mm, v.deepest_mm, v.turned, v.shreds, v.shredsBefore,
             v.farMoved_mm, v.folded, v.pairs, r.wall_s, fmt::join(v.broken(), ", "));
  std::fflush(out);
}

Json benchStrokes(Context& context, const StrokesOptions& options) {
  const std::uint64_t seed = numberIn(options.seed);
  const EstimateOn where = options.wants("vulkan") ? EstimateOn::gpu : EstimateOn::cpu;
  const auto count = static_cast<std::size_t>(options.strokes), models = options.models.size();
  StrokesResults results;
  const auto numbersOn = [&](std::size_t model) {
    std::vector<std::size_t> numbers;
    if (options.only >= 0) {
      if (static_cast<std::size_t>(options.only) % models == model)
        numbers.push_back(static_cast<std::size_t>(options.only));
      return numbers;
    }
    for (std::size_t k = model; k < count; k += models) numbers.push_back(k);
    return numbers;
  };
  for (std::size_t m = 0; m < models; ++m) {
    const auto numbers = numbersOn(m);
    if (numbers.empty()) continue;
    StrokeModel subject(context, options.models[m], where);
    for (const std::size_t k : numbers) {
      PlannedStroke plan = planStroke(subject, options.brushes, seed, k, options.hand == "mouse");
      play(context, subject, options, plan, options.only >= 0 ? options.saveWorst : "");
      results.strokes.push_back(plan.result);
      if (options.only >= 0 || !plan.result.verdict.broken().empty()) printStroke(context.tables(), plan.result);
    }
  }
  std::vector<const StrokeResult*> worst;
  for (const StrokeResult& stroke : results.strokes)
    if (stroke.verdict.badness() > 0) worst.push_back(&stroke);
  std::ranges::sort(worst, std::greater(), [](const StrokeResult* s) { return s->verdict.badness(); });
  worst.resize(std::min(worst.size(), kSavedWorst));
  printTable(context.tables(), results.strokes);
  fmt::print(context.tables(), "\nthe worst, each repeated by --only NUMBER with the same models and seed {}\n",
             options.seed);
  for (const StrokeResult* stroke : worst) printStroke(context.tables(), *stroke);
  if (!options.saveWorst.empty() && options.only < 0)
    for (std::size_t m = 0; m < models; ++m) {
      std::optional<StrokeModel> subject;
      for (const StrokeResult* stroke : worst) {
        if (stroke->number % models != m) continue;
        if (!subject) subject.emplace(context, options.models[m], where);
        PlannedStroke plan = planStroke(*subject, options.brushes, seed, stroke->number, options.hand == "mouse");
        play(context, *subject, options, plan, options.saveWorst);
      }
    }
  std::ranges::sort(results.strokes, {}, &StrokeResult::number);
  fmt::print(context.tables(), "\n{} of {} strokes fail a criterion\n", results.broken(), results.strokes.size());
  return jsonBy(kStrokesRows, results);
}

}  // namespace

void listStrokesBenchResults(std::vector<ResultFacts>& all) {
  listAlone(all, "strokes", ".", kStrokesRows);
  listAlone(all, "strokes", ".strokes[].", kStrokeRows);
}

void addStrokesBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("strokes", "judge random strokes of every brush on models, thin parts above all");
  const auto options = std::make_shared<StrokesOptions>();
  options->backend.surface = "average";
  sub.add("--models,--model", options->models,
          cloudFormats().namesRead() + " files; of more than 100,000 points a part")
      .typeName("FILE...")
      .required();
  sub.add("--strokes", options->strokes, "number of strokes").check(wholeBetween(1, bounds::kMaxCount)).showDefault();
  sub.add("--seed", options->seed, "seed of the strokes, a hexadecimal number").typeName("HEX").showDefault();
  sub.add("--only", options->only, "play only the stroke of this number")
      .check(wholeBetween(0, bounds::kMaxCount))
      .typeName("K");
  sub.add(
         "--save-worst", options->saveWorst,
         "folder for the points before and after, and the hand's path, of the worst strokes (with --only: of that one)")
      .typeName("FOLDER");
  addListOption(sub, "--brushes", options->brushes, "brushes to test");
  sub.add("--hand", options->hand,
          "path: walks over the surface; mouse: a drag over a picture, as in the window, with a press of 2.5 mm")
      .check(oneOf({"path", "mouse"}))
      .showDefault();
  options->backends = {"cpu"};
  sub.add("--backend", options->backends, "cpu or vulkan").check(oneOf({"cpu", "vulkan"})).showDefault();
  addRadiusOption(sub, options->backend);
  addEngineOptions(sub, options->backend);
  sub.footer(
      "Half of the strokes start on thin parts, folds or borders, half have the default brush, 2 mm deep at 50 mm/s; "
      "the others have radius, depth and speed by the seed. Stroke K plays on model K modulo the number of models, in "
      "virtual time. Exit code 0 however many strokes fail: the table says which.\n");
  sub.whenNamed([&command, &context, options] { command = measuringAlone(context, options, "strokes", benchStrokes); });
}

}  // namespace palpate
