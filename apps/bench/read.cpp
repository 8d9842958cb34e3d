// What it costs to read a file of points, from the system's memory where it was read before.
#include <filesystem>

#include "apps/bench/bench.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

namespace {

struct ReadRecord {
  std::string file, format;
  std::size_t points = 0;
  std::uintmax_t bytes = 0;
  Summary time_s;

  double perSecond(double amount) const { return time_s.p50 > 0 ? amount / time_s.p50 : 0; }
};

ReadRecord measure(Context& context, const std::string& file, const BenchOptions& options) {
  ReadRecord record{.file = file, .format = std::string(cloudFormats().toRead(file).name)};
  std::error_code isFolder;
  record.bytes = std::filesystem::file_size(file, isFolder);
  if (isFolder) record.bytes = 0;
  const auto once = [&] {
    const Stopwatch watch;
    record.points = readCloud(file, nullptr, {.threads = context.threads()}).cloud.size();
    return watch.elapsed_s();
  };
  once();  // what it reads is in memory then
  std::vector<double> times_s;
  repeatMeasurement(options, [&](std::int64_t) { times_s.push_back(once()); });
  record.time_s = summarize(std::move(times_s));
  return record;
}

Json benchRead(Context& context, const BenchOptions& options) {
  Json records = Json::array();
  std::FILE* out = context.tables();
  fmt::print(out, "{:<32} {:<6} {:>12} {:>8} {:>9} {:>9} {:>12} {:>8}\n", "file", "format", "points", "reads", "p50 s",
             "max s", "M points/s", "GB/s");
  for (const std::string& file : options.models) {
    const ReadRecord record = measure(context, file, options);
    const double points = record.perSecond(static_cast<double>(record.points)) * 1e-6;
    const double bytes = record.perSecond(static_cast<double>(record.bytes)) * 1e-9;
    fmt::print(out, "{:<32} {:<6} {:>12} {:>8} {:>9.3f} {:>9.3f} {:>12.1f} {:>8.2f}\n",
               std::filesystem::path(file).filename().string(), record.format, record.points, record.time_s.count,
               record.time_s.p50, record.time_s.max, points, bytes);
    records.push_back({{"file", record.file},
                       {"format", record.format},
                       {"points", record.points},
                       {"bytes", record.bytes},
                       {"threads", threadCount(context.threads())},
                       {"time_s", summaryOf(record.time_s)},
                       {"points_per_s", points * 1e6},
                       {"bytes_per_s", bytes * 1e9}});
  }
  return records;
}

}  // namespace

void addReadBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("read", "how fast files are read that the system has in memory");
  const auto options = std::make_shared<BenchOptions>();
  options->backends.clear();
  options->repeat = 20;
  sub.add("file", options->models, cloudFormats().namesRead() + " files").required().typeName("FILE...");
  addRepeatOptions(sub, *options);
  sub.footer(
      "Each file is read once before it is measured. --threads says how many threads read LAS and LAZ; other formats "
      "are "
      "read as always.\n");
  sub.whenNamed([&, options] {
    command = [&context, options] {
      measureAlone(context, *options, "read", [&] { return benchRead(context, *options); });
    };
  });
}

}  // namespace palpate
