// Cost of selecting and cleaning points.
#include "apps/bench/bench.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/select/chosen_points.hpp"
#include "engine/select/cleaning.hpp"
#include "engine/select/expression.hpp"
#include "engine/select/field_rule.hpp"

namespace palpate {

namespace {

struct SelectRecord {
  std::string model, operation;
  std::size_t points = 0, left = 0;
  Summary time_ms;
};

constexpr Reported<SelectRecord> kSelect[]{
    {"model", "", "name of the model", field<&SelectRecord::model>},
    {"points", "", "its points", field<&SelectRecord::points>},
    {"operation", "", "what was done with all points", field<&SelectRecord::operation>},
    {"left", "", "points that it selects or keeps", field<&SelectRecord::left>},
    {"time_ms", "ms", "time of it", quantiles<&SelectRecord::time_ms>},
};

/// An operation, and how many points it selects or keeps.
struct Operation {
  const char* name;
  std::function<std::size_t(const PointCloud&)> run;
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
         return applyRule("--set", fmt::format("red = 255 if z > {}", low), kept, options);
       }},
      {"duplicates", [=](const PointCloud& cloud) { return duplicatePoints(cloud, threads).count(); }},
      {"subsample: 4 spacings",
       [=](const PointCloud& cloud) { return onePointPerCell(cloud, 4 * spacing, threads).count(); }},
      {"outliers: 8 neighbours",
       [=](const PointCloud& cloud) { return statisticalOutliers(cloud, 8, 1, threads).count(); }},
      {"radius outliers: 4 in 4 spacings",
       [=](const PointCloud& cloud) { return radiusOutliers(cloud, 4, 4 * spacing, threads).count(); }},
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

Json benchSelect(Context& context, const BenchOptions& options) {
  std::vector<SelectRecord> records;
  for (const SubjectMaker& make : subjectsOf(options)) {
    const Subject subject = make(context);
    for (const Operation& operation : operationsOn(subject.model, context.threads())) {
      SelectRecord& record = records.emplace_back(
          SelectRecord{.model = subject.name, .operation = operation.name, .points = subject.model.cloud.size()});
      std::vector<double> times_ms;
      repeatMeasurement(options, [&](std::int64_t) {
        const Stopwatch watch;
        record.left = operation.run(subject.model.cloud);
        times_ms.push_back(watch.elapsed_us() * 1e-3);
      });
      record.time_ms = summarize(std::move(times_ms));
    }
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
  Options& sub = bench.addSubcommand("select", "cost of selecting and cleaning points, on the CPU");
  const auto options = std::make_shared<BenchOptions>();
  options->backends = {"cpu"};
  options->repeat = 20;
  addSubjectOptions(sub, *options);
  addRepeatOptions(sub, *options);
  sub.whenNamed([&, options] {
    command = [&context, options] {
      measureAlone(context, *options, "select", [&] { return benchSelect(context, *options); });
    };
  });
}

}  // namespace palpate
