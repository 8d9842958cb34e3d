#include "apps/context.hpp"
#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/ply_writer.hpp"
#include "engine/core/clock.hpp"

namespace palpate {

namespace {

constexpr std::size_t kDefaultPoints = 500'000;

struct MakeOptions {
  std::string shape, output, center = "0,0,0";
  std::size_t count = kDefaultPoints;
  std::uint64_t seed = 1;
  double noise = 0, size = 100;
  bool ascii = false;
};

void make(Context& context, const MakeOptions& options) {
  const Stopwatch watch;
  const auto shape = makeShape(options.shape, options.size, parseVec3(options.center, "--center"));
  const PointCloud cloud = sampleShape(*shape, {.count = options.count,
                                                .seed = options.seed,
                                                .noise = options.noise,
                                                .threads = context.threads()});
  writePly(options.output, cloud, {.ascii = options.ascii});
  context.log().say("{}: {} points of {} in {:.2f} s", options.output, cloud.size(), options.shape, watch.elapsed_s());
  context.writeJson({{"file", options.output}, {"shape", options.shape}, {"points", cloud.size()}});
}

}  // namespace

void addMake(CLI::App& app, Context& context, Command& command) {
  CLI::App* sub = app.add_subcommand("make", "an analytic cloud with exact normals, evenly sampled");
  auto options = std::make_shared<MakeOptions>();
  std::string names;
  for (const std::string_view name : shapeNames()) names += (names.empty() ? "" : ", ") + std::string(name);
  sub->add_option("shape", options->shape, "one of " + names)->required()->type_name("SHAPE");
  sub->add_option("-n,--points", options->count, "number of points")->capture_default_str();
  sub->add_option("-o,--output", options->output, "PLY file to write")->required()->type_name("FILE");
  sub->add_option("--seed", options->seed, "turns the sampling and picks the noise; same seed, same bytes")
      ->capture_default_str();
  sub->add_option("--noise", options->noise, "deviation of the positions from the surface along each axis, model units")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  sub->add_option("--center", options->center, "x,y,z of the middle, model units")->capture_default_str();
  sub->add_option("--size", options->size, "longest side, model units")->check(CLI::PositiveNumber)->capture_default_str();
  sub->add_flag("--ascii", options->ascii, "write ASCII instead of binary little-endian");
  sub->callback([&, options] { command = [&context, options] { make(context, *options); }; });
}

}  // namespace palpate
