// Cost of selecting and cleaning points.
#include <numeric>
#include <thread>

#include "apps/bench/bench.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/contact/neighbour_distances.hpp"
#include "engine/contact/normal_estimate.hpp"
#include "engine/render/drawn_attributes.hpp"
#include "engine/select/chosen_points.hpp"
#include "engine/select/cleaning.hpp"
#include "engine/select/expression.hpp"
#include "engine/select/field_rule.hpp"
#include "haptics/builtin_path.hpp"
#include "haptics/devices/path_device.hpp"

namespace palpate {

namespace {

struct SelectRecord {
  std::string model, operation;
  std::size_t points = 0, left = 0;
  Summary time_ms;
  std::optional<std::uint64_t> ticks = {}, missedTicks = {};
};

template <auto member>
std::optional<Json> ofHand(const SelectRecord& record) {
  return record.*member ? std::optional(Json(*(record.*member))) : std::nullopt;
}

constexpr Reported<SelectRecord> kSelect[]{
    {"model", "", "name of the model", field<&SelectRecord::model>},
    {"points", "", "its points", field<&SelectRecord::points>},
    {"operation", "", "what was done with all points", field<&SelectRecord::operation>},
    {"left", "", "points that it selects or keeps", field<&SelectRecord::left>},
    {"time_ms", "ms", "time of it; of a hand: from pose to force", quantiles<&SelectRecord::time_ms>},
    {"ticks", "", "ticks of a hand", ofHand<&SelectRecord::ticks>},
    {"missed_ticks", "", "ticks of it that were skipped because their time had passed",
     ofHand<&SelectRecord::missedTicks>},
};

/// An operation, and how many points it selects or keeps.
struct Operation {
  const char* name;
  std::function<std::size_t(const PointCloud&)> run;
  std::function<double()> time_ms = nullptr;  ///< of a part of the last run; null: of all of it
};

std::vector<Operation> operationsOn(const Model& model, unsigned threads) {
  const double spacing = model.spacing, low = boundsOf(model.cloud).center().z;
  const FieldOptions options{.up = UpAxis::z, .threads = threads};
  const auto where = [=](const std::string& condition) {
    return [=](const PointCloud& cloud) {
      CloudFields fields(cloud, options);
      return static_cast<std::size_t>(pointsWhere("--where", condition, fields).count());
    };
  };
  return {
      {"expression: one comparison", where(fmt::format("z > {}", low))},
      {"expression: four fields",
       where(fmt::format("z > {} && nx * nx + ny * ny < 0.5 || abs(x) < {}", low, 10 * spacing))},
      {"filter: selected points as a cloud",
       [=](const PointCloud& cloud) {
         CloudFields fields(cloud, options);
         return chosenPoints(cloud, pointsWhere("--where", fmt::format("z > {}", low), fields), threads).size();
       }},
      {"recolour where a condition holds",
       [=, kept = model.cloud](const PointCloud&) mutable {
         return applyRule("--set", fmt::format("red = 255 if z > {}", low), kept, options).set;
       }},
      {"duplicates", [=](const PointCloud& cloud) { return duplicatePoints(cloud, threads).count(); }},
      {"subsample: 4 spacings",
       [=](const PointCloud& cloud) { return onePointPerCell(cloud, 4 * spacing, threads).count(); }},
      {"outliers: 8 neighbours",
       [=](const PointCloud& cloud) { return statisticalOutliers(cloud, 8, 1, threads).count(); }},
      {"radius outliers: 4 in 4 spacings",
       [=](const PointCloud& cloud) { return radiusOutliers(cloud, 4, 4 * spacing, threads).count(); }},
      {"normals: 16 neighbours, not oriented",
       [=](const PointCloud& cloud) {
         constexpr unsigned kNeighbours = 16;
         const Places places = distinctPlaces(cloud.positions, threads);
         std::vector<std::uint32_t> all(places.positions.size());
         std::iota(all.begin(), all.end(), 0u);
         std::vector<FittedPlane> planes(all.size());
         NeighbourGraph graph{.degree = kNeighbours, .neighbours = {}};
         graph.neighbours.resize(kNeighbours * all.size());
         fitNearestPlanes(places.positions, all, kNeighbours, planes, graph, threads);
         return planes.size();
       }},
      {"normals: 16 neighbours, oriented",
       [=](const PointCloud& cloud) {
         PointCloud bare;
         bare.positions = cloud.positions;
         estimateNormals(bare, 16, threads);
         return bare.size();
       }},
      {"field: density", where("density > 0")},
  };
}

std::vector<Operation> operationsOnGpu(Context& context) {
  Device& device = context.device();
  const unsigned threads = context.threads();
  const auto cost = std::make_shared<NormalEstimateCost>();
  const auto normals = [=, &device](const PointCloud& cloud) {
    PointCloud bare;
    bare.positions = cloud.positions;
    *cost = estimateNormals(device, bare, threads);
    return bare.size() - cost->onHost;
  };
  const auto distances = [&device](const PointCloud& cloud, std::uint32_t neighbours, unsigned many) {
    return neighbourDistances(device, cloud, neighbours, many);
  };
  return {{"vulkan: outliers: 8 neighbours",
           [=](const PointCloud& cloud) { return statisticalOutliers(cloud, 8, 1, threads, distances).count(); }},
          {"vulkan: normals, oriented on the CPU", normals},
          {"vulkan: normals, not oriented", normals, [=] { return cost->planes_ms; }},
          {"vulkan: normals, index and passes alone", normals, [=] { return cost->passes_ms; }}};
}

/// What a command does with half of the points of a session, in an order in which each changes something.
struct Change {
  const char* name;
  std::function<void(Session&)> run;
};

std::vector<Change> changesOf(const Model& model, Device* drawing) {
  PointSet half;
  const double middle = boundsOf(model.cloud).center().z;
  for (std::size_t i = 0; i < model.cloud.size(); ++i)
    if (model.cloud.positions[i].z > middle) half.set(i);
  const auto undo = [](Session& session) { session.undo(1, 0); };
  const auto mask = [](MaskRole role, const PointSet& points) {
    return [=](Session& session) { session.setMask(role, points); };
  };
  const auto change = [&](const PointsAction& action) {
    return [=](Session& session) { session.changePoints(half, action); };
  };
  const auto slide = [](double strength) {
    return [=](Session& session) { session.setStrokeLayer(0, {.name = "a", .strength = strength}, false, true); };
  };
  const auto move = change(MovePoints{.offset = {0, 0, 0.1 * model.spacing}});
  const auto moveInLayer = [=](Session& session) {
    session.setStrokeLayer(0, {.name = "a"}, true);
    move(session);
  };
  std::vector<Change> changes{{"select half", mask(MaskRole::selected, half)},
                              {"select none", mask(MaskRole::selected, {})},
                              {"lock half", mask(MaskRole::locked, half)},
                              {"unlock", mask(MaskRole::locked, {})},
                              {"hide half", mask(MaskRole::hidden, half)},
                              {"show all", mask(MaskRole::hidden, {})},
                              {"remove half", change(RemovePoints())},
                              {"undo of that", undo},
                              {"paint half", change(PaintPoints{packedColor({255, 0, 0, 255})})},
                              {"undo of that", undo},
                              {"move half", move},
                              {"undo of that", undo}};
  constexpr std::size_t kMaxLayered = 4'000'000;  // the first slide of more takes minutes
  if (model.cloud.size() <= kMaxLayered)
    changes.insert(changes.end(), {{"move half in a layer of strokes", moveInLayer},
                                   {"first slide of that layer", slide(0.9)},
                                   {"further slide of that layer", slide(0.8)},
                                   {"undo of that", [](Session& session) { session.undo(3, 0); }}});
  if (!drawing) return changes;
  const auto count = static_cast<std::uint32_t>(model.cloud.size());
  changes.push_back(
      {"colour by other numbers", [shown = std::make_shared<DrawnAttributes>(*drawing, count),
                                   numbers = std::vector<float>(count)](Session&) { shown->show(numbers); }});
  return changes;
}

/// Which ones are measured.
enum class Measured { all, cloud, session };
constexpr std::array<std::pair<std::string_view, Measured>, 3> kMeasured{
    {{"all", Measured::all}, {"cloud", Measured::cloud}, {"session", Measured::session}}};

// Each with a session's points, history and back end.
void benchChanges(Context& context, const BenchOptions& options, const Subject& subject,
                  std::vector<SelectRecord>& records) {
  for (const std::string& backend : options.backends) {
    const std::vector<Change> changes = changesOf(subject.model, backend == "cpu" ? nullptr : &context.device());
    BenchBackend on = options.backend;
    on.backend = backend;
    Session session = startSession(context, subject.model, on,
                                   {.brush = BrushConfig(), .keepsPoints = true, .undo_bytes = std::uint64_t{8} << 30});
    std::vector<std::vector<double>> times_ms(changes.size());
    repeatMeasurement(options, [&](std::int64_t) {
      for (std::size_t i = 0; i < changes.size(); ++i) {
        const Stopwatch watch;
        changes[i].run(session);
        times_ms[i].push_back(watch.elapsed_us() * 1e-3);
      }
    });
    for (std::size_t i = 0; i < changes.size(); ++i)
      records.push_back({.model = subject.name,
                         .operation = fmt::format("{}: {}", backend, changes[i].name),
                         .points = subject.model.cloud.size(),
                         .left = session.history()->points().present(),
                         .time_ms = summarize(std::move(times_ms[i]))});
  }
}

/// A hand in real time: alone, and beside these changes, in turns.
struct HandBeside {
  static constexpr int kRounds = 5;
  double duration_s = 0;  ///< of each turn; 0: no hand
};

void benchHand(Context& context, const BenchOptions& options, const Subject& subject, const HandBeside& hand,
               std::vector<SelectRecord>& records) {
  for (const std::string& backend : options.backends) {
    const std::vector<Change> changes = changesOf(subject.model, nullptr);
    BenchBackend on = options.backend;
    on.backend = backend;
    on.realtime = true;
    Session session = startSession(context, subject.model, on,
                                   {.brush = BrushConfig(), .keepsPoints = true, .undo_bytes = std::uint64_t{8} << 30});
    PathDevice device(builtinPath("slide", subject.model.cloud, subject.model.scale));
    session.start({{.device = &device}}, {});
    std::array<std::vector<double>, 2> step_ms;  // alone, beside
    std::array<std::uint64_t, 2> missed{};
    std::vector<TraceRow> rows;
    session.live()->take(rows);
    for (int turn = 0; turn < 2 * HandBeside::kRounds; ++turn) {
      const auto beside = static_cast<std::size_t>(turn % 2);
      const Stopwatch watch;
      // Whole passes over the changes, so that the points are the same at the end.
      while (watch.elapsed_s() < hand.duration_s) {
        for (const Change& change : beside ? changes : std::vector<Change>()) change.run(session);
        if (!beside) std::this_thread::sleep_for(std::chrono::milliseconds(10));
        rows.clear();
        session.live()->take(rows);
        for (const TraceRow& row : rows) {
          step_ms[beside].push_back(row.step_us * 1e-3);
          missed[beside] += row.missed;
        }
      }
    }
    const std::string fault = session.isLive() ? "" : session.live()->fault();
    session.stop();
    if (!fault.empty()) throw Error("bench select: the hand was stopped: {}", fault);
    for (std::size_t beside = 0; beside < 2; ++beside)
      records.push_back({.model = subject.name,
                         .operation = fmt::format("{}: a hand {}", backend, beside ? "beside all of these" : "alone"),
                         .points = subject.model.cloud.size(),
                         .left = session.history()->points().present(),
                         .time_ms = summarize(step_ms[beside]),
                         .ticks = step_ms[beside].size(),
                         .missedTicks = missed[beside]});
  }
}

Json benchSelect(Context& context, const BenchOptions& options, Measured measured, const HandBeside& hand) {
  std::vector<SelectRecord> records;
  for (const SubjectMaker& make : subjectsOf(options)) {
    const Subject subject = make(context);
    std::vector<Operation> operations;
    if (measured != Measured::session) {
      if (options.wants("cpu")) operations = operationsOn(subject.model, context.threads());
      if (options.wants("vulkan")) std::ranges::move(operationsOnGpu(context), std::back_inserter(operations));
    }
    for (const Operation& operation : operations) {
      SelectRecord& record = records.emplace_back(
          SelectRecord{.model = subject.name, .operation = operation.name, .points = subject.model.cloud.size()});
      std::vector<double> times_ms;
      repeatMeasurement(options, [&](std::int64_t) {
        const Stopwatch watch;
        record.left = operation.run(subject.model.cloud);
        times_ms.push_back(operation.time_ms ? operation.time_ms() : watch.elapsed_us() * 1e-3);
      });
      record.time_ms = summarize(std::move(times_ms));
    }
    if (measured != Measured::cloud) benchChanges(context, options, subject, records);
    if (hand.duration_s > 0) benchHand(context, options, subject, hand, records);
  }
  const Json json = arrayBy(kSelect, records);
  printTables(context.tables(), "select", json);
  return json;
}

}  // namespace

void listSelectBenchResults(std::vector<ResultFacts>& all) {
  constexpr DescribedKey records[]{{"select", "", "one for each operation"}};
  listResults(all, "bench select", "", records);
  listAlone(all, "select", "[].", kSelect);
}

void addSelectBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("select", "cost of selecting, changing and cleaning points");
  const auto options = std::make_shared<BenchOptions>();
  options->backends = {"cpu"};
  addBackendsOption(sub, *options, {"cpu", "vulkan"});
  options->repeat = 20;
  addSubjectOptions(sub, *options);
  addRepeatOptions(sub, *options);
  const auto measured = std::make_shared<std::string>("all");
  sub.add("--of", *measured, "operations on a cloud, or of a session").check(oneOf(namesOf(kMeasured))).showDefault();
  const auto hand = std::make_shared<HandBeside>();
  sub.add("--beside", hand->duration_s,
          "also count the ticks that a hand misses at 1 kHz, alone and beside the operations of a session in turns of "
          "that many seconds, five of each")
      .check(between(bounds::kShortest_s, bounds::kLongest_s));
  sub.whenNamed([&, options, measured, hand] {
    command = [&context, options, measured, hand] {
      measureAlone(context, *options, "select",
                   [&] { return benchSelect(context, *options, *valueNamed(kMeasured, *measured), *hand); });
    };
  });
}

}  // namespace palpate
