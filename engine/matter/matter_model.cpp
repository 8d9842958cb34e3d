#include "engine/matter/matter_model.hpp"

#include <algorithm>
#include <cmath>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/worker_team.hpp"
#include "engine/matter/matter_rules.hpp"
#include "engine/matter/soft_scan.hpp"

namespace palpate {

namespace {

// Number of cells (in which the model is filled) and field nodes per spacing.
constexpr double kNodesInSpacing = 2;
constexpr int kNodesInSupport = static_cast<int>(kNodesInSpacing * kSupport_spacings);
constexpr std::size_t kOfBlock = 256;
// Number of points of a built-in model per squared spacing, on each of the six sides of its box.
constexpr double kPointsInSquare = 30, kMaxPoints = 4e5;

// Number of nodes beyond the outermost cell: the reach of the weights, or the radius of a ball that touches it.
int nodesBeyond(const MatterScene& scene) {
  const double ball = std::ceil(kNodesInSpacing * scene.tool.radius_mm / particleSpacing_mm(scene));
  return std::max(kNodesInSupport, static_cast<int>(ball)) + 2;
}

// The points at the model's position in the scene, m.
std::vector<SurfacePlace> placed(PointCloud cloud, const MatterScene& scene, unsigned threads) {
  const auto [low, high] = modelBox_mm(scene);
  MatterScene stand = scene;
  stand.fill_mm = high - low;
  std::vector<SurfacePlace> points = placeScan(std::move(cloud), stand, threads);
  const DVec3 middle = DVec3(scene.box_mm.x, 0, scene.box_mm.z) / 2.0;
  const Vec3 move((DVec3((low.x + high.x) / 2, low.y, (low.z + high.z) / 2) - middle) * 1e-3);
  for (SurfacePlace& point : points) point.rest += move;
  return points;
}

// The model filled into cells, with a margin for all weights that reach it.
struct Filled {
  shared::ModelField field{};
  double spacing_m = 0;
  std::vector<float> share;  // filled share of each node's cell

  std::size_t nodeOf(const IVec3& node) const { return shared::modelNode(field, node); }
  IVec3 placeOf(std::size_t number) const {
    const auto n = static_cast<int>(number);
    return {n % field.nodes.x, n / field.nodes.x % field.nodes.y, n / field.nodes.x / field.nodes.y};
  }
  DVec3 at(const IVec3& node) const { return DVec3(field.corner) + spacing_m * DVec3(node); }
};

Filled filledOf(const LatticeBox& box, int beyond) {
  Filled filled{.spacing_m = box.spacing_m};
  filled.field.corner = box.corner + (0.5 - beyond) * box.spacing_m;
  filled.field.nodesPerMetre = static_cast<float>(1 / box.spacing_m);
  filled.field.nodes = box.cells + 2 * beyond;
  filled.share.resize(std::size_t(filled.field.nodes.x) * std::size_t(filled.field.nodes.y) *
                      std::size_t(filled.field.nodes.z));
  for (std::size_t cell = 0; cell < box.filled.size(); ++cell)
    filled.share[filled.nodeOf(box.cellOf(cell) + beyond)] = box.filled[cell];
  return filled;
}

// A neighbour cell and its normalised weight.
struct Beside {
  IVec3 offset;
  double weight;
};

std::vector<Beside> weightsOfCells() {
  std::vector<Beside> cells;
  double sum = 0;
  for (int z = -kNodesInSupport; z <= kNodesInSupport; ++z)
    for (int y = -kNodesInSupport; y <= kNodesInSupport; ++y)
      for (int x = -kNodesInSupport; x <= kNodesInSupport; ++x) {
        const double r = glm::length(DVec3(x, y, z)) / kNodesInSupport;
        if (r >= 1) continue;
        cells.push_back({{x, y, z}, shared::wendland(r)});
        sum += cells.back().weight;
      }
  for (Beside& cell : cells) cell.weight /= sum;
  return cells;
}

// Share of the weight around a node that is inside.
double shareAt(const Filled& filled, const IVec3& node, std::span<const Beside> cells) {
  double share = 0;
  for (const Beside& cell : cells) {
    const IVec3 other = glm::clamp(node + cell.offset, IVec3(0), filled.field.nodes - 1);
    share += cell.weight * static_cast<double>(filled.share[filled.nodeOf(other)]);
  }
  return share;
}

}  // namespace

MatterModel::MatterModel(PointCloud cloud, const MatterScene& scene, unsigned threads)
    : points_(placed(std::move(cloud), scene, threads)) {
  const double spacing_m = particleSpacing_mm(scene) * 1e-3, support_m = kSupport_spacings * spacing_m;
  WorkerTeam team(threads);
  const Filled filled =
      filledOf(fillScan(points_, spacing_m / kNodesInSpacing, scene.hole_mm * 1e-3, team).box, nodesBeyond(scene));
  std::vector<Vec3> places;
  for (const SurfacePlace& point : points_) places.push_back(point.rest);
  const PointTree tree(places);
  const std::vector<Beside> cells = weightsOfCells();
  std::vector<Vec2> nodes(filled.share.size());
  team.forEach((nodes.size() + kOfBlock - 1) / kOfBlock, [&](std::size_t block) {
    for (std::size_t n = block * kOfBlock; n < std::min((block + 1) * kOfBlock, nodes.size()); ++n) {
      const IVec3 node = filled.placeOf(n);
      // Distance of the plane that hides the same share; thin parts hide less than thick ones, so there the points
      // determine the distance.
      const double share = shareAt(filled, node, cells), plane = distanceOfShare(share);
      std::uint32_t nearest = 0;
      double distance2 = 0;
      tree.nearest(Vec3(filled.at(node)), {&nearest, 1}, {&distance2, 1});
      const double point = (filled.share[n] > 0.5f ? -1 : 1) * std::sqrt(distance2);
      nodes[n] = Vec2(share, share > 0 ? std::min(plane * support_m, point) : point);
    }
  });
  field_ = filled.field;
  field_.nearest = static_cast<float>(kModelNearest_spacings * spacing_m);
  nodes_.reserve(nodes.size());
  const double cell_m3 = std::pow(filled.spacing_m, 3);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Vec2 here = nodes[n], next = nodes[std::min(n + 1, nodes.size() - 1)];
    nodes_.emplace_back(here.x, next.x, here.y, next.y);
    volume_m3_ += cell_m3 * static_cast<double>(filled.share[n]);
    middle_ += cell_m3 * static_cast<double>(filled.share[n]) * filled.at(filled.placeOf(n));
  }
  middle_ /= volume_m3_;
}

std::size_t leaveOut(std::vector<Vec3>& places, const MatterModel& model) {
  return std::erase_if(places, [&](const Vec3& place) { return model.at(place).distance < model.field().nearest; });
}

PointCloud builtInModel(const MatterScene& scene, unsigned threads) {
  const auto [low, high] = modelBox_mm(scene);
  const double size = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  const auto shape = makeShape(std::string_view(scene.model).substr(kBuiltInModel.size()), size);
  const double points = 6 * kPointsInSquare * std::pow(size / scene.spacing_mm, 2);
  return sampleShape(*shape,
                     {.count = static_cast<std::size_t>(std::clamp(points, 2e4, kMaxPoints)), .threads = threads});
}

}  // namespace palpate
