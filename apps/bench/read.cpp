// Cost of reading a file of points from the system's page cache.
#include <array>
#include <filesystem>
#include <optional>

#include "apps/bench/bench.hpp"
#include "engine/core/page_faults.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

namespace {

struct ReadRecord {
  std::string file, format;
  std::size_t points = 0;
  unsigned threads = 1;
  std::uintmax_t bytes = 0;
  Summary time_s;
  // Medians of the stages (header, points, finish, free, wait for memory), and of page faults.
  std::array<double, 5> stages{};
  std::optional<double> faults;

  double perSecond(double amount) const { return time_s.p50 > 0 ? amount / time_s.p50 : 0; }
};

ReadRecord measure(Context& context, const std::string& file, const BenchOptions& options) {
  ReadRecord record{
      .file = file, .format = std::string(cloudFormats().toRead(file).name), .threads = threadCount(context.threads())};
  std::error_code isFolder;
  record.bytes = std::filesystem::file_size(file, isFolder);
  if (isFolder) record.bytes = 0;
  std::vector<double> times_s, faults;
  std::array<std::vector<double>, 5> stages;
  const auto once = [&] {
    ReadStages now;
    const std::uint64_t before = pageFaults().value_or(0);
    const Stopwatch watch;
    std::optional<StoredCloud> stored = readCloud(file, nullptr, {.threads = context.threads(), .stages = &now});
    const double read_s = watch.elapsed_s();
    record.points = stored->cloud.size();
    stored.reset();
    times_s.push_back(watch.elapsed_s());
    faults.push_back(static_cast<double>(pageFaults().value_or(0) - before));
    const std::array<double, 5> all{now.open_s, now.points_s, now.finish_s, times_s.back() - read_s, now.waited_s};
    for (std::size_t k = 0; k < all.size(); ++k) stages[k].push_back(all[k]);
  };
  once();  // brings the file into the page cache
  times_s.clear(), faults.clear();
  for (auto& stage : stages) stage.clear();
  repeatMeasurement(options, [&](std::int64_t) { once(); });
  record.time_s = summarize(std::move(times_s));
  if (pageFaults()) record.faults = summarize(std::move(faults)).p50;
  for (std::size_t k = 0; k < stages.size(); ++k) record.stages[k] = summarize(std::move(stages[k])).p50;
  return record;
}

using Value = std::optional<Json>;

constexpr Reported<ReadRecord> kRead[]{
    {"file", "", "read file", field<&ReadRecord::file>},
    {"format", "", "its format", field<&ReadRecord::format>},
    {"points", "", "its points", field<&ReadRecord::points>},
    {"bytes", "B", "its size; 0: a folder", [](const ReadRecord& r) -> Value { return std::uint64_t{r.bytes}; }},
    {"threads", "", "threads that read", field<&ReadRecord::threads>},
    {"time_s", "s", "time of a read, and to free it", quantiles<&ReadRecord::time_s>},
    {"stages.open_s", "s", "median time of the header", [](const ReadRecord& r) -> Value { return r.stages[0]; }},
    {"stages.points_s", "s", "of the points", [](const ReadRecord& r) -> Value { return r.stages[1]; }},
    {"stages.finish_s", "s", "to finish them", [](const ReadRecord& r) -> Value { return r.stages[2]; }},
    {"stages.free_s", "s", "to free them", [](const ReadRecord& r) -> Value { return r.stages[3]; }},
    {"stages.waited_s", "s", "in which threads waited for memory, summed over threads",
     [](const ReadRecord& r) -> Value { return r.stages[4]; }},
    {"stages.page_faults", "", "median number of page faults; null: unknown",
     [](const ReadRecord& r) -> Value { return orNull(r.faults); }},
    {"points_per_s", "1/s", "points per second",
     [](const ReadRecord& r) -> Value { return r.perSecond(static_cast<double>(r.points)); }},
    {"bytes_per_s", "B/s", "bytes per second",
     [](const ReadRecord& r) -> Value { return r.perSecond(static_cast<double>(r.bytes)); }},
};

Json benchRead(Context& context, const BenchOptions& options) {
  Json records = Json::array();
  for (const std::string& file : options.models) records.push_back(jsonBy(kRead, measure(context, file, options)));
  printTables(context.tables(), "read", records);
  return records;
}

}  // namespace

void listReadBenchResults(std::vector<ResultFacts>& all) {
  constexpr DescribedKey records[]{{"read", "", "one for each file"}};
  listResults(all, "bench read", "", records);
  listAlone(all, "read", "[].", kRead);
}

void addReadBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("read", "reading speed of files in the system's page cache");
  const auto options = std::make_shared<BenchOptions>();
  options->backends.clear();
  options->repeat = 20;
  sub.add("file", options->models, cloudFormats().namesRead() + " files").required().typeName("FILE...");
  addRepeatOptions(sub, *options);
  sub.footer(
      "Each file is read once before it is measured. --threads sets the number of threads for LAS and LAZ only.\n");
  sub.whenNamed([&, options] { command = measuringAlone(context, options, "read", benchRead); });
}

}  // namespace palpate
