#include "apps/cli/context.hpp"
#include "apps/cli/output.hpp"
#include "apps/cli/progress.hpp"
#include "engine/cloud/analytic_shape.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/saving.hpp"

namespace palpate {

namespace {

constexpr std::int64_t kDefaultPoints = 500'000;
constexpr double kMaxPoints = 2'000'000'000;
constexpr double kSmallestSize = 1e-12, kLargestSize = 1e15;  // model units
constexpr double kFarthest = 1e28;                            // from the origin, model units

struct MakeOptions {
  std::string shape, output, center = "0,0,0";
  std::int64_t count = kDefaultPoints;
  std::int64_t seed = 1;
  double noise = 0, size = 100;
  bool ascii = false;
};

void make(Context& context, const MakeOptions& options) {
  const Stopwatch watch;
  const DVec3 center = parseVec3(options.center, "--center");
  if (!(glm::length(center) <= kFarthest))
    throw UsageError("--center: {} lies farther from the origin than {} units", options.center, kFarthest);
  checkOutput(options.output, Output::points);
  const auto shape = makeShape(options.shape, options.size, center);
  Progress progress(context.log(), options.output);
  constexpr double kSampling = 0.6;  // estimated share of the time
  PointCloud cloud = sampleShape(*shape, {.count = static_cast<std::size_t>(options.count),
                                          .seed = static_cast<std::uint64_t>(options.seed),
                                          .noise = options.noise,
                                          .threads = context.threads(),
                                          .progress = [&](double share) { progress.set(kSampling * share); }});
  markAsOurs(cloud);
  std::filesystem::path kept;
  writeCloud(options.output, cloud,
             {.ascii = options.ascii,
              .keptAs = whereToKeep(options.output, kept, context.log()),
              .progress = [&](double share) { progress.set(kSampling + (1 - kSampling) * share); }});
  context.log().say("{}: {} of {} in {:.2f} s", options.output, counted(cloud.size(), "point"), options.shape,
                    watch.elapsed_s());
  context.writeJson({{"file", options.output}, {"shape", options.shape}, {"points", cloud.size()}});
}

}  // namespace

void addMake(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand("make", "make an evenly sampled analytic cloud with exact normals");
  auto options = std::make_shared<MakeOptions>();
  std::string names;
  for (const std::string_view name : shapeNames()) names += (names.empty() ? "" : ", ") + std::string(name);
  sub.add("shape", options->shape, "one of " + names)
      .required()
      .typeName("SHAPE")
      .offers({shapeNames().begin(), shapeNames().end()});
  sub.add("-n,--points", options->count, "number of points").check(wholeBetween(1, kMaxPoints)).showDefault();
  sub.add("-o,--output", options->output, "output: " + cloudFormats().endingsWritten(Written::points))
      .required()
      .typeName("OUT.ply")
      .writes(Writes::keeping);
  sub.add("--seed", options->seed, "seed of the sampling and the noise; the same seed gives the same bytes")
      .check(wholeBetween(0, bounds::kMaxSeed))
      .showDefault();
  sub.add("--noise", options->noise, "standard deviation of the noise of the positions along each axis, model units")
      .check(between(0, kLargestSize))
      .showDefault();
  sub.add("--center", options->center, "centre x,y,z, model units").showDefault();
  sub.add("--size", options->size, "longest side, model units")
      .check(between(kSmallestSize, kLargestSize))
      .showDefault();
  sub.addFlag("--ascii", options->ascii, "write ASCII in place of binary little-endian");
  sub.whenNamed([&, options] { command = [&context, options] { make(context, *options); }; });
}

}  // namespace palpate
