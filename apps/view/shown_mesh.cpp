#include "apps/view/shown_mesh.hpp"

#include <algorithm>
#include <utility>

#include "apps/cli/mesh_options.hpp"
#include "apps/view/session.hpp"
#include "engine/core/clock.hpp"

namespace palpate {

bool ShownMesh::follow(const WindowSession& session, std::uint32_t resolution, std::span<const PointState> edited) {
  const Stopwatch watch;
  if (!mesh_ || resolution_ != resolution) {
    if (sight_.isCpu() && !std::exchange(isAnnounced_, true)) return false;
    isAnnounced_ = false;
    make(session, resolution);
    hide(session);
  } else {
    if (!edited.empty()) mesh_->update(edited);
    if (!hide(session) && edited.empty()) return true;
  }
  ++version_;
  time_ms_ = watch.elapsed_us() * 1e-3;
  return true;
}

void ShownMesh::make(const WindowSession& session, std::uint32_t resolution) {
  mesh_.reset();
  hidden_ = {};
  const Model& model = session.model();
  const MeshPlan plan =
      thinned(planMesh(model.shownBounds(), model.spacing, {.resolution = resolution, .room = 0.2}), model.cloud);
  const PointStates& points = session.history().points();
  const std::uint64_t most = std::max(points.size(), model.cloud.size());
  const std::uint64_t spare = std::max<std::uint64_t>(most - model.cloud.size(), model.cloud.size() / 4);
  mesh_ = std::make_unique<MarchingCubes>(sight_, model.cloud, plan, static_cast<std::uint32_t>(spare), true);
  resolution_ = resolution;
  mesh_->build();
  if (session.edits() > 0) mesh_->update(points);
}

bool ShownMesh::hide(const WindowSession& session) {
  const PointSet& hidden = session.attributes().mask(MaskRole::hidden);
  if (hidden == hidden_) return false;
  PointSet flipped = hidden_;
  flipped.flip(hidden);
  std::vector<PointState> states;
  const PointStates& points = session.history().points();
  flipped.forEach([&](std::uint64_t point) {
    states.push_back(points[point]);
    states.back().gone |= hidden.test(point);
  });
  mesh_->update(states);
  hidden_ = hidden;
  return true;
}

std::filesystem::path ShownMesh::write(const std::string& file, std::vector<std::string>& lost) const {
  if (triangleCount() == 0) throw Error("{}: there are no triangles to write; press M to make them", file);
  std::filesystem::path kept;
  const Mesh mesh = mesh_->download();
  lost = lostInMeshFile(file, mesh);
  writeMesh(file, mesh, static_cast<double>(mesh_->plan().lattice.cell), false, &kept);
  return kept;
}

void ShownMesh::clear() {
  mesh_.reset();
  isAnnounced_ = false;
}

DrawnMesh ShownMesh::drawn(const Bounds& bounds) const {
  return {.vertices = mesh_->vertices().address(),
          .triangles = mesh_->triangles().address(),
          .triangleCount = mesh_->triangleCount(),
          .hasColors = mesh_->hasColors(),
          .bounds = bounds,
          .cell = static_cast<double>(mesh_->plan().lattice.cell)};
}

}  // namespace palpate
