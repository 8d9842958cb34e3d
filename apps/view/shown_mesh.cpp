#include "apps/view/shown_mesh.hpp"

#include <algorithm>
#include <utility>

#include "apps/cli/mesh_options.hpp"
#include "apps/view/session.hpp"
#include "engine/core/clock.hpp"
#include "haptics/session/colored_field.hpp"

namespace palpate {

bool ShownMesh::follow(const WindowSession& session, std::uint32_t resolution, const EditBatch& edited,
                       const ColoredField* field, const ColorConfig& color) {
  const Stopwatch watch;
  const PointStates& points = session.history().points();
  const bool isNew = !mesh_ || resolution_ != resolution;
  if (isNew) {
    if (sight_.isCpu() && !std::exchange(isAnnounced_, true)) return false;
    isAnnounced_ = false;
    make(session, resolution);
  }
  // A stroke changes no colours but those of its points.
  FieldColors shown = field ? field->colors(color) : FieldColors();
  const bool isNumbered = std::exchange(shown_.version, shown.version) != shown.version;
  const std::string by = field ? color.by : std::string();
  const bool isRecolored = isNew || by != by_ || (field && (shown != shown_ || color.mapOf() != map_)) ||
                           (isNumbered && edited.points.empty());
  if (isRecolored || isNumbered)
    colors_ = field ? field->pointColors(color) : std::vector<std::array<std::uint8_t, 4>>();
  const bool had = !std::exchange(by_, by).empty();
  map_ = color.mapOf(), shown_ = shown;
  std::vector<PointState> states = hidden(session);
  if (isRecolored && (field || had || (isNew && session.edits() > 0)))
    states.assign(points.begin(), points.end());
  else
    states.insert(states.begin(), edited.points.begin(), edited.points.end());
  if (states.empty() && !isNew) return true;
  update(std::move(states));
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
}

std::vector<PointState> ShownMesh::hidden(const WindowSession& session) {
  const PointSet& hidden = session.attributes().mask(MaskRole::hidden);
  std::vector<PointState> states;
  if (hidden == hidden_) return states;
  PointSet flipped = std::exchange(hidden_, hidden);
  flipped.flip(hidden);
  flipped.forEach([&](std::uint64_t point) { states.push_back(session.history().points()[point]); });
  return states;
}

void ShownMesh::update(std::vector<PointState> states) {
  for (PointState& state : states) {
    state.gone |= hidden_.test(state.number);
    if (state.number < colors_.size()) state.color = packedColor(colors_[state.number]);
  }
  if (!states.empty()) mesh_->update(states);
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
