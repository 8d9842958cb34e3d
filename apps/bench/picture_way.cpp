#include "apps/bench/picture_way.hpp"

#include <fmt/format.h>

namespace palpate {

namespace {

void visitDiscs(Context& context, const Model& model, const std::string& name,
                const std::function<void(const PictureWay&)>& visit) {
  const std::uint64_t before = context.device().allocatedBytes();
  const DrawnCloud drawn(context.device(), model.cloud, {.spacing = model.spacing});
  PictureWay way{.name = name, .made_ms = {}, .bytes = context.device().allocatedBytes() - before, .discs = &drawn};
  way.record = [&](Frame& frame, CommandList& list, const Camera& camera, FrameOptions options) {
    options.raster = rasterNamed(name);
    frame.record(list, drawn, camera, options);
  };
  visit(way);
}

void visitMesh(Context& context, const Model& model, std::int64_t resolution, const BenchOptions& options,
               const std::function<void(const PictureWay&)>& visit) {
  const std::uint64_t before = context.device().allocatedBytes();
  MarchingCubes cubes = makeCubes(context, model, planFor(model, {.resolution = resolution}));
  cubes.build();
  std::vector<double> made_ms;
  repeatMeasurement(options, [&](std::int64_t) { made_ms.push_back(1e-3 * cubes.build().gpu_us.total()); });
  PictureWay way{.name = fmt::format("mesh {}", resolution),
                 .made_ms = summarize(made_ms),
                 .bytes = context.device().allocatedBytes() - before};
  const DrawnMesh drawn = drawnMesh(cubes, model);
  way.record = [&](Frame& frame, CommandList& list, const Camera& camera, const FrameOptions& frameOptions) {
    frame.record(list, drawn, camera, frameOptions);
  };
  visit(way);
}

}  // namespace

void forEachWay(Context& context, const Model& model, const WayOptions& options,
                const std::function<void(const PictureWay&)>& visit) {
  for (const std::string& raster : options.rasters) visitDiscs(context, model, raster, visit);
  for (const std::int64_t resolution : options.meshes) visitMesh(context, model, resolution, options, visit);
}

}  // namespace palpate
