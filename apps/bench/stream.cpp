// Cost of fusing depth frames into a map that is touched, and the map's accuracy.
#include <algorithm>
#include <deque>
#include <functional>
#include <numbers>

#include "apps/bench/bench.hpp"
#include "apps/bench/stream_felt.hpp"
#include "apps/cli/parse_list.hpp"
#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/ray_cast.hpp"
#include "engine/core/parallel.hpp"
#include "engine/motion/frame_fusion.hpp"
#include "engine/motion/fusion_pass.hpp"
#include "engine/spatial/spatial_hash.hpp"

namespace palpate {

namespace {

// A sphere of six metres, seen from a distance of two metres: five million points on it are as far apart as the pixels
// of a camera of 640 x 480 at that distance.
constexpr double kSize_m = 6, kBefore_m = 2;
// The frames are repeated in a cycle, each from its own position.
constexpr std::uint64_t kViews = 8;
constexpr double kTurn_rad = 0.01;  // between successive views

struct StreamBenchOptions : BenchOptions {
  std::vector<std::string> frames{"640x480", "1280x720"};
  double noise = 1;
  double felt_s = 0;
};

// A camera with a typical field of view.
DepthCamera cameraOf(const std::string& size) {
  const auto [width, height] = parseList<std::uint32_t, 2>(size, 'x', "--frames", "WIDTHxHEIGHT in pixels");
  const double focal = 525.0 / 640 * width;
  return {
      .width = width, .height = height, .fx = focal, .fy = focal, .cx = 0.5 * width - 0.5, .cy = 0.5 * height - 0.5};
}

CameraPose viewOf(std::uint64_t view) {
  const double angle = kTurn_rad * static_cast<double>(view);
  const DQuat turn(std::cos(0.5 * angle), 0, std::sin(0.5 * angle), 0);
  return {.turn = turn, .centre = turn * DVec3(0, 0, -0.5 * kSize_m - kBefore_m)};
}

// Depths of the sphere with a depth camera's noise, scaled by `noise`.
DepthFrame frameOf(const AnalyticShape& shape, const DepthCamera& camera, std::uint64_t view, double noise,
                   unsigned threads) {
  const FusionOptions usual;
  const TracedSurface surface = traced(shape);
  DepthFrame frame{.number = view, .pose = viewOf(view)};
  frame.depth_m.resize(std::size_t{camera.width} * camera.height);
  frame.colors.assign(frame.depth_m.size(), {180, 170, 150});
  parallelFor(frame.depth_m.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      const DVec3 ray =
          camera.placeAt(static_cast<double>(pixel % camera.width), static_cast<double>(pixel / camera.width), 1);
      const auto hit = castRay(surface, {.from = frame.pose->centre, .along = frame.pose->turn * ray});
      if (!hit) continue;
      const double beyond = std::max(hit->depth - usual.noiseFrom_m, 0.0);
      const double deviation = usual.noiseLeast_m + usual.noiseGrowth_per_m * beyond * beyond;
      frame.depth_m[pixel] =
          static_cast<float>(hit->depth + noise * deviation * static_cast<double>(randomNormal3(view, pixel).x));
    }
  });
  return frame;
}

double spacingOf(const PointCloud& map) {
  return std::sqrt(std::numbers::pi * kSize_m * kSize_m / static_cast<double>(map.size()));
}

// Frames fused into a map.
struct Fused {
  std::string frames;       // their size
  std::size_t surfels = 0;  // points of the map
  Summary fuse_us, index_us, arrival_us;
  std::vector<std::pair<std::string, double>> passes_us;  // in their order: medians, each pass timed alone
  FusionCounts counts;                                    // counts of the last frame
};

// Fuses frames into an existing map and rebuilds its index, as the touch side does.
Fused fuse(Device& device, const PointCloud& map, const DepthCamera& camera, const std::vector<DepthFrame>& frames,
           const StreamBenchOptions& options) {
  FusionOptions fusion;
  fusion.capacity = map.size() + map.size() / 5 + frames.front().depth_m.size();
  LiveCloud live(device, map, static_cast<std::uint32_t>(fusion.capacity - map.size()));
  const HashGrid grid = makeHashGrid(Vec3(boundsOf(map).min), 4 * spacingOf(map), live.slots());
  const SpatialHash hash(device, grid, live.slots(), kDefaultSort, BucketOrder::arrival, Slots::spare);
  const LiveCloud::Half incoming{Buffer::of<Vec4>(device, live.slots(), Memory::device, "incoming positions"),
                                 Buffer::of<Vec4>(device, live.slots(), Memory::device, "incoming normals"), 0};
  FusionPass pass(device, camera, fusion, live.slots());
  pass.reset(device.latencyQueue(), map);
  std::deque<CommandList> lists, timed;
  for (int turn = 0; turn < 2; ++turn) {
    for (const auto timing : {CommandList::Timing::sections, CommandList::Timing::passes}) {
      auto& all = timing == CommandList::Timing::passes ? timed : lists;
      CommandList& list = all.emplace_back(device, device.latencyQueue(), "frame", timing);
      list.begin();
      pass.record(list, live.front(), incoming);
      hash.recordBuild(list, incoming, live.back(), live.slots(), kDefaultSort);
      list.end();
    }
    live.flip();
  }
  FrameImages images;
  const auto bring = [&](std::int64_t i, const CommandList& list) {
    const DepthFrame& frame = frames[static_cast<std::size_t>(i) % frames.size()];
    readFrame(camera, frame, fusion, images);
    pass.put(images, *frame.pose, DVec3(0));
    device.latencyQueue().run(list);
    live.flip();
  };
  for (std::uint64_t view = 0; view < kViews; ++view)  // all views are seen once
    bring(static_cast<std::int64_t>(view), lists[live.parity()]);
  std::vector<double> fuse_us, index_us, arrival_us;
  repeatMeasurement(options, [&](std::int64_t i) {
    const Stopwatch watch;
    const CommandList& list = lists[live.parity()];
    bring(i, list);
    arrival_us.push_back(watch.elapsed_us());
    fuse_us.push_back(list.sectionTime_us("fusion"));
    index_us.push_back(list.sectionTime_us("hash"));
  });
  Fused fused{.frames = {},
              .surfels = map.size(),
              .fuse_us = summarize(fuse_us),
              .index_us = summarize(index_us),
              .arrival_us = summarize(arrival_us),
              .passes_us = {},
              .counts = pass.counts()};
  std::vector<std::vector<double>> times;
  for (std::uint64_t i = 0; i < 2 * kViews; ++i) {
    const CommandList& list = timed[live.parity()];
    bring(static_cast<std::int64_t>(i), list);
    const std::vector<PassRecord> passes = list.passes();
    times.resize(passes.size());
    for (std::size_t k = 0; k < passes.size(); ++k) times[k].push_back(passes[k].gpu_us);
    if (fused.passes_us.empty())
      for (const PassRecord& each : passes) fused.passes_us.emplace_back(each.name, 0);
  }
  for (std::size_t k = 0; k < times.size(); ++k) fused.passes_us[k].second = summarize(times[k]).p50;
  return fused;
}

// A map that began empty, against the shape.
struct StreamQuality {
  std::string size;  // of the frames
  std::size_t frames = 0, points = 0;
  double depthRms_mm = 0, mapRms_mm = 0;  // distances from the shape of the measured depths and of the map's points
};

StreamQuality judge(const AnalyticShape& shape, const DepthCamera& camera, const std::vector<DepthFrame>& frames,
                    unsigned threads) {
  FusionOptions options;
  options.threads = threads;
  FrameFusion fusion(options);
  double noise = 0;
  std::size_t measured = 0;
  for (const DepthFrame& frame : frames) {
    fusion.fuse(camera, frame);
    for (std::size_t pixel = 0; pixel < frame.depth_m.size(); ++pixel) {
      if (frame.depth_m[pixel] <= 0) continue;
      const auto column = static_cast<double>(pixel % camera.width), row = static_cast<double>(pixel / camera.width);
      const DVec3 place = frame.pose->toWorld(camera.placeAt(column, row, static_cast<double>(frame.depth_m[pixel])));
      noise += std::pow(shape.signedDistance(place), 2);
      ++measured;
    }
  }
  double squares = 0;
  const PointCloud cloud = fusion.map().cloud();
  for (std::size_t i = 0; i < cloud.size(); ++i) squares += std::pow(shape.signedDistance(cloud.fileCoordinates(i)), 2);
  const auto rms_mm = [](double sum, std::size_t count) {
    return 1e3 * std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
  };
  return {.size = {},
          .frames = frames.size(),
          .points = cloud.size(),
          .depthRms_mm = rms_mm(noise, measured),
          .mapRms_mm = rms_mm(squares, cloud.size())};
}

using Value = std::optional<Json>;
using PassTime = std::pair<std::string, double>;

constexpr Reported<PassTime> kPasses[]{{"pass", "", "its name", field<&PassTime::first>},
                                       {"us", "us", "median time", field<&PassTime::second>}};

constexpr Reported<Fused> kFused[]{
    {"frames", "px", "size of the frames", field<&Fused::frames>},
    {"surfels", "", "points of the map", field<&Fused::surfels>},
    {"matched", "", "pixels matched with points of the map, in the last frame",
     [](const Fused& f) -> Value { return f.counts.matched; }},
    {"appended", "", "points appended by it", [](const Fused& f) -> Value { return f.counts.appended; }},
    {"removed", "", "points removed by it", [](const Fused& f) -> Value { return f.counts.removed; }},
    {"fuse_us", "us", "time to fuse a frame on the GPU", quantiles<&Fused::fuse_us>},
    {"index_us", "us", "time to index the map on the GPU", quantiles<&Fused::index_us>},
    {"arrival_us", "us", "time from a decoded frame to the points that a hand feels", quantiles<&Fused::arrival_us>},
    {"passes", "", "each pass, timed alone", [](const Fused& f) -> Value { return arrayBy(kPasses, f.passes_us); }},
};

constexpr Reported<FeltStream> kFelt[]{
    {"situation", "", "still, latest or fused", field<&FeltStream::situation>},
    {"ticks", "", "ticks", field<&FeltStream::ticks>},
    {"contact_ticks", "", "ticks in contact", field<&FeltStream::contactTicks>},
    {"missed_ticks", "", "ticks skipped because their time had passed", field<&FeltStream::missedTicks>},
    {"fresh_fraction", "1", "fraction of ticks answered in time", field<&FeltStream::freshShare>},
    {"step_us", "us", "time from pose to force", quantiles<&FeltStream::step_us>},
    {"frames", "", "frames that were felt", field<&FeltStream::frames>},
    {"frames_dropped", "", "frames dropped, as a newer one had arrived", field<&FeltStream::framesDropped>},
    {"frames_drawn", "", "frames that were drawn", field<&FeltStream::framesDrawn>},
    {"pictures_per_s", "1/s", "pictures per second", field<&FeltStream::pictures_per_s>},
    {"frames_of", "px", "size of the frames", field<&FeltStream::framesOf>},
    {"surfels", "", "points of the map", field<&FeltStream::surfels>},
};

constexpr Reported<StreamQuality> kStreamQualities[]{
    {"frames", "", "its frames", field<&StreamQuality::frames>},
    {"points", "", "its points", field<&StreamQuality::points>},
    {"depth_rms_mm", "mm", "root mean square distance of the measured depths from the shape",
     field<&StreamQuality::depthRms_mm>},
    {"map_rms_mm", "mm", "root mean square distance of the map's points from the shape",
     field<&StreamQuality::mapRms_mm>},
    {"size", "px", "size of the frames", field<&StreamQuality::size>},
};

struct StreamResults {
  std::vector<Fused> fused;
  std::vector<FeltStream> felt;
  std::vector<StreamQuality> qualities;
};

constexpr Reported<StreamResults> kStreamBench[]{
    {"rows", "", "one for each size of frames and of the map",
     [](const StreamResults& r) -> Value { return arrayBy(kFused, r.fused); }},
    {"felt", "", "touch while frames arrive (--felt)",
     [](const StreamResults& r) -> Value { return arrayBy(kFelt, r.felt); }},
    {"truth", "", "one for each size of frames: a map that began empty",
     [](const StreamResults& r) -> Value { return arrayBy(kStreamQualities, r.qualities); }},
};

Json benchStream(Context& context, const StreamBenchOptions& options) {
  const auto shape = makeShape("sphere", kSize_m);
  StreamResults results;
  const auto felt = [&](const std::string& size, const PointCloud& map, const DepthCamera& camera,
                        const std::vector<DepthFrame>& frames) {
    const auto all = feelStreams(context, {.map = map,
                                           .camera = camera,
                                           .frames = frames,
                                           .framesOf = size,
                                           .radius_m = 0.5 * kSize_m,
                                           .spacing_m = spacingOf(map),
                                           .duration_s = options.felt_s});
    std::ranges::copy(all, std::back_inserter(results.felt));
  };
  for (const std::string& size : options.frames) {
    const DepthCamera camera = cameraOf(size);
    std::vector<DepthFrame> frames;
    for (std::uint64_t view = 0; view < kViews; ++view)
      frames.push_back(frameOf(*shape, camera, view, options.noise, context.threads()));
    for (const std::int64_t surfels : options.sizes) {
      const PointCloud map =
          sampleShape(*shape, {.count = static_cast<std::size_t>(surfels), .threads = context.threads()});
      warmUp(context, options);
      Fused fused = fuse(context.device(), map, camera, frames, options);
      fused.frames = size;
      results.fused.push_back(std::move(fused));
      if (options.felt_s > 0) felt(size, map, camera, frames);
    }
    results.qualities.push_back(judge(*shape, camera, frames, context.threads()));
    results.qualities.back().size = size;
  }
  Json json = jsonBy(kStreamBench, results);
  printTables(context.tables(), "stream", json);
  return json;
}

}  // namespace

void listStreamBenchResults(std::vector<ResultFacts>& all) {
  listAlone(all, "stream", ".", kStreamBench);
  listAlone(all, "stream", ".rows[].", kFused);
  listAlone(all, "stream", ".rows[].passes[].", kPasses);
  listAlone(all, "stream", ".felt[].", kFelt);
  listAlone(all, "stream", ".truth[].", kStreamQualities);
}

void addStreamBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("stream", "fusion of depth frames into a map and its index");
  const auto options = std::make_shared<StreamBenchOptions>();
  sub.add("--sizes", options->sizes, "numbers of points in the map").check(wholeBetween(1, 1e8)).typeName("N...");
  sub.add("--frames", options->frames, "sizes of the frames, WIDTHxHEIGHT in pixels").separatedBy(',').showDefault();
  sub.add("--noise", options->noise, "noise of the depths relative to a structured-light camera")
      .check(between(0, 100))
      .showDefault();
  sub.add("--felt", options->felt_s,
          "also feel the map in real time while it is drawn, without and with frames, s each; 0: skip")
      .check(between(0, bounds::kLongest_s))
      .showDefault();
  addRepeatOptions(sub, *options);
  sub.footer(
      "Frames of a sphere of six metres, seen from two metres by a slowly circling camera, are fused into a map of it; "
      "on 1 and 5 million points unless --sizes says otherwise. Tables of GPU time to fuse and index a frame, of the "
      "time from a decoded frame to the points that a hand feels, and of the distance from the sphere of the points "
      "of a map that began empty.\n");
  sub.whenNamed([&, options] {
    if (options->sizes.empty()) options->sizes = {1'000'000, 5'000'000};
    command = measuringAlone(context, options, "stream", benchStream);
  });
}

}  // namespace palpate
