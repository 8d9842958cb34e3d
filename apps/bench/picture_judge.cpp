#include "apps/bench/picture_judge.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/parallel.hpp"
#include "engine/core/statistics.hpp"

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

constexpr double kSameSurface_spacings = 3;  // farther behind the true surface another one is seen through a hole

Camera aslant(const PointCloud& cloud, double aspect) {
  Camera camera = Camera::fitting(cloud, aspect);
  const double distance = 1.1 * glm::distance(camera.eye, camera.target);
  camera.target = boundsOf(cloud).center();
  camera.eye = camera.target + distance * glm::normalize(DVec3(0.8, 0.55, 1));
  camera.setDepthRange(boundsOf(cloud), boundsOf(cloud).longestSide());
  return camera;
}

DVec3 decodedNormal(const std::array<std::uint8_t, 4>& rgba) {
  return glm::normalize(DVec3(rgba[0], rgba[1], rgba[2]) / 127.5 - 1.0);
}

}  // namespace

void forEachWay(Context& context, const Model& model, const WayOptions& options,
                const std::function<void(const PictureWay&)>& visit) {
  for (const std::string& raster : options.rasters) visitDiscs(context, model, raster, visit);
  for (const std::int64_t resolution : options.meshes) visitMesh(context, model, resolution, options, visit);
}

PictureTruth pictureTruth(const TracedSurface& surface, const PointCloud& cloud, std::uint32_t width,
                          std::uint32_t height, std::uint32_t stride, unsigned threads) {
  PictureTruth truth{.camera = aslant(cloud, static_cast<double>(width) / height),
                     .width = width,
                     .height = height,
                     .stride = stride,
                     .depth = {},
                     .normal = {}};
  const std::size_t columns = truth.columns(), rays = columns * truth.rows();
  truth.depth.resize(rays);
  truth.normal.resize(rays);
  const Camera::Axes axes = truth.camera.axes();
  const double focal = truth.camera.focal_px(height);
  parallelFor(rays, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const double x = static_cast<double>(k % columns * stride) + 0.5 - width / 2.0;
      const double y = static_cast<double>(k / columns * stride) + 0.5 - height / 2.0;
      const auto hit =
          castRay(surface, {truth.camera.eye + cloud.origin, axes.forward + (x * axes.right - y * axes.up) / focal});
      if (!hit) continue;
      truth.depth[k] = static_cast<float>(hit->depth);
      truth.normal[k] = Vec3(hit->normal);
    }
  });
  return truth;
}

PictureJudgement judgePicture(const PictureTruth& truth, const DepthImage& depth, const Image& normals,
                              double spacing) {
  PictureJudgement result;
  const std::size_t columns = truth.columns(), rows = truth.rows();
  const auto there = [&](std::size_t column, std::size_t row) { return truth.depth[row * columns + column] > 0; };
  std::size_t both = 0, either = 0;
  double squares = 0;
  std::vector<double> angles;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const auto x = static_cast<std::uint32_t>(column * truth.stride);
      const auto y = static_cast<std::uint32_t>(row * truth.stride);
      const bool wanted = there(column, row), shown = depth.at(x, y) > 0;
      both += wanted && shown;
      either += wanted || shown;
      if (!wanted) continue;
      ++result.pixels;
      const double error = static_cast<double>(depth.at(x, y) - truth.depth[row * columns + column]) / spacing;
      const bool inside = column > 0 && row > 0 && column + 1 < columns && row + 1 < rows && there(column - 1, row) &&
                          there(column + 1, row) && there(column, row - 1) && there(column, row + 1);
      result.holes += inside && (!shown || error > kSameSurface_spacings);
      if (!shown || std::abs(error) > kSameSurface_spacings) continue;
      squares += error * error;
      angles.push_back(angleBetween_deg(decodedNormal(normals.at(x, y)), DVec3(truth.normal[row * columns + column])));
    }
  if (angles.empty()) return result;
  const double count = static_cast<double>(angles.size());
  result.overlap = 100.0 * static_cast<double>(both) / static_cast<double>(either);
  result.depthRms = std::sqrt(squares / count);
  for (const double angle : angles) result.normalMean_deg += angle / count;
  std::ranges::sort(angles);
  result.normalP95_deg = quantileOfSorted(angles, 0.95);
  return result;
}

}  // namespace palpate
