#include <algorithm>

#include "apps/bench/cub_times.hpp"
#include "apps/bench/times.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/spatial/look_back_sort.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "engine/study/dynamic_tree.hpp"

namespace palpate {

namespace {

// The cloud before a tick's rebuild: in the order of the last build, with some points moved by one cell.
PointCloud inLastOrder(const PointCloud& cloud, const HashGrid& grid, double movedShare) {
  SortedGrid sorted(grid);
  sorted.build(cloud.positions);
  PointCloud ordered;
  ordered.origin = cloud.origin;
  ordered.positions.reserve(cloud.size());
  ordered.normals.reserve(cloud.size());
  for (const SortedGrid::Placed& point : sorted.placed()) {
    ordered.positions.push_back(point.position);
    ordered.normals.push_back(cloud.normals[point.number]);
  }
  const auto movers = static_cast<std::size_t>(movedShare * static_cast<double>(cloud.size()));
  for (std::size_t k = 0; k < movers; ++k) ordered.positions[k * cloud.size() / movers].x += 1 / grid.inverseCell;
  return ordered;
}

struct Input {
  const char* name;
  const PointCloud& cloud;
};

Summary measureVulkan(Device& device, const PointCloud& cloud, const HashGrid& grid, SortMethod sort, BucketOrder order,
                      const BenchOptions& options) {
  LiveCloud live(device, cloud);
  const SpatialHash hash(device, grid, live.count(), sort, order);
  CommandList list(device, device.latencyQueue(), "build", CommandList::Timing::sections);
  list.begin();
  // Never flipped: every repetition has the same input.
  hash.recordBuild(list, live.front(), live.back(), live.slots(), sort);
  list.end();
  return measureSection(device, list, "hash", options);
}

template <class Search>
Summary measureCpu(Search& search, const PointCloud& cloud, const BenchOptions& options) {
  search.build(cloud.positions);
  std::vector<double> times;
  repeatMeasurement(options, [&](std::int64_t) {
    const Stopwatch watch;
    search.build(cloud.positions);
    times.push_back(watch.elapsed_us());
  });
  return summarize(times);
}

// Cost of following an edit of a thousand points.
template <class Search>
Summary measureCpuMove(Search& search, PointCloud cloud, float distance, const BenchOptions& options) {
  constexpr std::size_t kMoved = 1000;
  search.build(cloud.positions);
  std::vector<PointMove> moves(std::min(kMoved, cloud.size()));
  const std::size_t first = (cloud.size() - moves.size()) / 2;
  std::vector<double> times;
  repeatMeasurement(options, [&](std::int64_t turn) {
    for (std::size_t k = 0; k < moves.size(); ++k) {
      Vec3& position = cloud.positions[first + k];
      moves[k] = {static_cast<std::uint32_t>(first + k), position};
      position.x += turn % 2 == 0 ? distance : -distance;
    }
    const Stopwatch watch;
    search.move(moves);
    times.push_back(watch.elapsed_us());
  });
  return summarize(times);
}

}  // namespace

void benchBuild(Context& context, const Subject& subject, const TimeBenchOptions& options,
                std::vector<BenchRecord>& records) {
  const PointCloud& cloud = subject.model.cloud;
  const HashGrid grid = gridFor(context, subject.model, options.backend);
  const PointCloud ordered = inLastOrder(cloud, grid, options.movedShare);
  const auto add = [&](const char* backend, std::string_view way, const std::string& input, const Summary& gpu_us,
                       const Summary& wall_us) {
    records.push_back({.bench = "build",
                       .backend = backend,
                       .way = std::string(way),
                       .input = input,
                       .subject = subject.name,
                       .points = cloud.size(),
                       .gpu_us = gpu_us,
                       .wall_us = wall_us});
  };
  const std::array inputs{Input{"file order", cloud}, Input{"last order", ordered}};
  if (options.wants("vulkan")) {
    Device& device = context.device();
    for (const Input& input : inputs) {
      for (const SortMethod sort : {SortMethod::radix, SortMethod::radixLookBack, SortMethod::counting}) {
        if (sort == SortMethod::radixLookBack && !LookBackSort::fits(device, bucketBits(grid))) continue;
        add("vulkan", nameOf(kSortMethods, sort), input.name,
            measureVulkan(device, input.cloud, grid, sort, BucketOrder::stable, options), {});
      }
      add("vulkan", "counting, arrival", input.name,
          measureVulkan(device, input.cloud, grid, SortMethod::counting, BucketOrder::arrival, options), {});
    }
  }
  if (options.wants("cuda"))
    for (const Input& input : inputs)
      add("cuda", "CUB", input.name, summarize(cubBuildTimes_us(input.cloud, grid, static_cast<int>(options.repeat))),
          {});
  if (options.wants("cpu")) {
    MultimapHash multimap(grid);
    SortedGrid sorted(grid, context.threads());
    PointTree tree;
    DynamicTree dynamic;
    const auto measure = [&](auto& search) {
      for (const Input& input : inputs)
        add("cpu", search.name(), input.name, {}, measureCpu(search, input.cloud, options));
      add("cpu", search.name(), "1000 points moved", {},
          measureCpuMove(search, ordered, 1 / grid.inverseCell, options));
    };
    measure(multimap);
    measure(sorted);
    measure(tree);
    measure(dynamic);
  }
}

}  // namespace palpate
