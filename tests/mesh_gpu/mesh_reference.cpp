#include "tests/mesh_gpu/mesh_reference.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "engine/contact/surface.hpp"
#include "engine/core/parallel.hpp"
#include "engine/mesh/cell_table.hpp"
#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

namespace {

constexpr double kUndefined = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kNoVertex = 0xffffffffu;

struct Field {
  bool defined = false;
  double value = 0;
  DVec3 normal{0};
};

/// The surface at any position, from the points around it.
class FieldReference {
 public:
  FieldReference(const PointCloud& cloud, const MeshPlan& plan, unsigned threads)
      : cloud_(cloud),
        plan_(plan),
        grid_(makeHashGrid(plan.lattice.origin, static_cast<double>(plan.lattice.radius), cloud.size()), threads) {
    std::vector<std::uint8_t> there(cloud.size());
    for (std::uint32_t i = 0; i < cloud.size(); ++i) there[i] = plan.uses(i);
    grid_.build(cloud.positions, there);
  }

  Field at(const DVec3& x) const {
    if (plan_.surface == MeshSurface::density) return densityAt(x);
    const auto kind = static_cast<SurfaceKind>(plan_.surface);
    const std::uint32_t passes = kind == SurfaceKind::sharp ? shared::kSharpPasses : 1;
    SurfaceSample sample{};
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
      SurfaceSums sums(kind, radius(), DVec3(0), pass > 0 ? &sample : nullptr);
      grid_.forEachNear(x, radius(), [&](const SortedGrid::Placed& point) {
        sums.add(DVec3(point.position) - x, cloud_.normals[point.number]);
      });
      const SurfaceSample next = sums.sample();
      if (!next.defined) break;
      sample = next;
    }
    return {sample.defined, sample.distance, sample.normal};
  }

 private:
  double radius() const { return static_cast<double>(plan_.lattice.radius); }
  Field densityAt(const DVec3& x) const {
    double density = 0;
    DVec3 slope(0);
    grid_.forEachNear(x, radius(), [&](const SortedGrid::Placed& point) {
      const DVec3 d = (DVec3(point.position) - x) / radius();
      const double r = glm::length(d);
      density += wendland(r) * static_cast<double>(plan_.lattice.densityScale);
      slope += (1 - r) * (1 - r) * (1 - r) * d;
    });
    const double steep = glm::length(slope);
    return {true, (static_cast<double>(shared::kMeshIsoDensity) - density) * radius(),
            steep > 0 ? -slope / steep : DVec3(0)};
  }

  const PointCloud& cloud_;
  const MeshPlan& plan_;
  SortedGrid grid_;
};

class Reference {
 public:
  Reference(const PointCloud& cloud, const MeshPlan& plan, unsigned threads)
      : lattice_(plan.lattice),
        field_(cloud, plan, threads),
        values_(std::size_t{shared::blockCount(plan.lattice)} * shared::kMeshBlockNodes, kUndefined),
        vertexOf_(3 * values_.size(), kNoVertex) {
    mesh_.vertices.origin = cloud.origin;
    parallelFor(values_.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t node = begin; node < end; ++node)
        if (const Field field = field_.at(DVec3(shared::nodePlace(lattice_, nodeAt(node)))); field.defined)
          values_[node] = field.value;
    });
    forEachCell([&](const UVec3& cell, unsigned inside) { noteVertices(cell, inside); });
    for (std::size_t edge = 0; edge < vertexOf_.size(); ++edge)
      if (vertexOf_[edge] != kNoVertex) placeVertex(edge);
    forEachCell([&](const UVec3& cell, unsigned inside) { addTriangles(cell, inside); });
  }
  Mesh take() { return std::move(mesh_); }

 private:
  // Nodes and cells in the order of blocks, and of positions in a block.
  UVec3 nodeAt(std::size_t number) const {
    const auto block = static_cast<std::uint32_t>(number / shared::kMeshBlockNodes);
    const auto place = static_cast<std::uint32_t>(number % shared::kMeshBlockNodes);
    return shared::blockOfNumber(lattice_, block) * shared::kMeshBlockSide + shared::localOf(place);
  }
  std::size_t numberOf(const UVec3& node) const {
    return std::size_t{shared::blockNumber(lattice_, node / shared::kMeshBlockSide)} * shared::kMeshBlockNodes +
           shared::inBlock(node % shared::kMeshBlockSide);
  }
  std::size_t edgeNumber(const UVec3& cell, unsigned edge) const {
    return 3 * numberOf(cell + shared::cornerOffset(lowCorner(edge))) + edge / 4;
  }

  template <class Visit>
  void forEachCell(Visit&& visit) const {
    const UVec3 last = lattice_.blocks * shared::kMeshBlockSide - 1u;
    for (std::size_t number = 0; number < values_.size(); ++number) {
      const UVec3 cell = nodeAt(number);
      if (cell.x >= last.x || cell.y >= last.y || cell.z >= last.z) continue;
      unsigned inside = 0;
      bool known = true;
      for (unsigned corner = 0; corner < 8; ++corner) {
        const double value = values_[numberOf(cell + shared::cornerOffset(corner))];
        known = known && value != kUndefined;
        inside |= value < 0 ? 1u << corner : 0u;
      }
      if (known && inside != 0 && inside != 255) visit(cell, inside);
    }
  }

  void noteVertices(const UVec3& cell, unsigned inside) {
    for (unsigned edge = 0; edge < 12; ++edge)
      if ((inside >> lowCorner(edge) & 1u) != (inside >> highCorner(edge) & 1u)) vertexOf_[edgeNumber(cell, edge)] = 0;
  }

  void placeVertex(std::size_t edge) {
    const auto axis = static_cast<int>(edge % 3);
    const UVec3 node = nodeAt(edge / 3);
    UVec3 next = node;
    next[axis] += 1;
    const double low = values_[edge / 3], high = values_[numberOf(next)];
    const DVec3 corner(shared::nodePlace(lattice_, node));
    const auto between = [&](double t) {
      DVec3 place = corner;
      place[axis] += t * static_cast<double>(lattice_.cell);
      return place;
    };
    double t = low / (low - high);
    const Field there = field_.at(between(t));
    if (there.defined) {
      if ((there.value < 0) == (low < 0))
        t += (1 - t) * there.value / (there.value - high);
      else
        t *= low / (low - there.value);
    }
    const double kClearance = static_cast<double>(shared::kMeshClearance);
    DVec3 normal = there.normal;
    if (glm::dot(normal, normal) < 0.5) normal[axis] = low < 0 ? 1 : -1;
    vertexOf_[edge] = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.positions.emplace_back(between(std::clamp(t, kClearance, 1 - kClearance)));
    mesh_.vertices.normals.emplace_back(normal);
  }

  void addTriangles(const UVec3& cell, unsigned inside) {
    const CellCase& cellCase = kCellCases[inside];
    for (std::size_t t = 0; t < cellCase.triangles; ++t) {
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = vertexOf_[edgeNumber(cell, cellCase.edges[3 * t + k])];
      mesh_.triangles.push_back(triangle);
    }
  }

  shared::MeshLattice lattice_;
  FieldReference field_;
  std::vector<double> values_;           // by node; kUndefined without a surface
  std::vector<std::uint32_t> vertexOf_;  // three edges for each node
  Mesh mesh_;
};

}  // namespace

Mesh meshReference(const PointCloud& cloud, const MeshPlan& plan, unsigned threads) {
  return Reference(cloud, plan, threads).take();
}

}  // namespace palpate
