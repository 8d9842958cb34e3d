#include "engine/render/ground.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr double kShadowRoom = 0.45;    // around the box, of its longest side
constexpr double kCell_spacings = 1.5;  // minimum: with fewer points in a cell, the shadow gets holes
constexpr std::uint64_t kCells = std::uint64_t{shared::kMaxGroundCells} * shared::kMaxGroundCells;

}  // namespace

shared::GroundMap groundMap(const Bounds& bounds, const DVec3& up, double spacing) {
  const DVec3 along = glm::abs(DVec3(up.z, up.x, up.y)), across = glm::abs(DVec3(up.y, up.z, up.x));
  const DVec3 size = bounds.max - bounds.min, middle = bounds.center();
  const double room = kShadowRoom * bounds.longestSide();
  const double side = std::max(glm::dot(size, along), glm::dot(size, across)) + 2 * room;
  const double wanted = std::max(side / shared::kMaxGroundCells, kCell_spacings * spacing);
  const auto cells = static_cast<std::uint32_t>(
      std::clamp(std::floor(side / std::max(wanted, 1e-30)), 1.0, double{shared::kMaxGroundCells}));
  const double lowest = std::min(glm::dot(bounds.min, up), glm::dot(bounds.max, up));
  const DVec3 corner =
      lowest * up + (glm::dot(middle, along) - 0.5 * side) * along + (glm::dot(middle, across) - 0.5 * side) * across;
  return {.corner = Vec3(corner),
          .cell = static_cast<float>(std::max(side / cells, 1e-30)),
          .up = Vec3(up),
          .cells = cells,
          .along = Vec3(along),
          .count = 0,
          .across = Vec3(across),
          .unused = 0};
}

Ground::Ground(Device& device)
    : heights_(device, shader_code::render_ground_heights, {.pushBytes = sizeof(shared::GroundHeightsArgs)}),
      hide_(device, shader_code::render_ground_shadow, {.pushBytes = sizeof(shared::GroundShadowArgs)}),
      blur_(device, shader_code::render_ground_blur, {.pushBytes = sizeof(shared::GroundShadowArgs)}),
      darken_(device, shader_code::render_ground, {.pushBytes = sizeof(shared::GroundArgs)}),
      heightMap_(deviceWords(device, 2 * kCells, "heights above the ground")),
      rough_(deviceWords(device, kCells, "shadow on the ground before its blur")),
      shadow_(deviceWords(device, kCells, "shadow on the ground")) {}

void Ground::follow(CommandList& list, const DrawnCloud& cloud, const shared::GroundMap& map) {
  const std::pair stamps(cloud.stamp(), cloud.attributes().changes());
  if (stamps == made_ && std::memcmp(&map, &map_, sizeof(map)) == 0) return;
  made_ = stamps;
  map_ = map;
  const Buffer* const hidden = cloud.attributes().mask(MaskRole::hidden);
  shared::GroundHeightsArgs args{.map = map,
                                 .positions = cloud.positions().address(),
                                 .hidden = hidden ? hidden->address() : 0,
                                 .vertices = 0,
                                 .triangles = 0,
                                 .heights = heightMap_.address()};
  args.map.count = cloud.count();
  make(list, args);
}

void Ground::follow(CommandList& list, const DrawnMesh& mesh, const shared::GroundMap& map) {
  made_ = {0, 0};  // a mesh does not tell when it has changed
  map_ = map;
  shared::GroundHeightsArgs args{.map = map,
                                 .positions = 0,
                                 .hidden = 0,
                                 .vertices = mesh.vertices,
                                 .triangles = mesh.triangles,
                                 .heights = heightMap_.address()};
  args.map.count = 3 * mesh.triangleCount;
  make(list, args);
}

void Ground::make(CommandList& list, const shared::GroundHeightsArgs& args) {
  const std::uint64_t cells = std::uint64_t{args.map.cells} * args.map.cells, bytes = sizeof(float) * cells;
  const auto section = list.section("ground map");
  list.fill(heightMap_, shared::kNoDepth, bytes);
  list.fill(heightMap_, 0, bytes, bytes);
  list.fill(rough_, 0, bytes);
  list.dispatch(heights_, args.map.count, args);
  const shared::GroundShadowArgs shadow{
      .map = args.map, .heights = heightMap_.address(), .rough = rough_.address(), .shadow = shadow_.address()};
  list.dispatch(hide_, cells * shared::kGroundDirections, shadow);
  list.dispatch(blur_, cells, shadow);
}

void Ground::recordShadow(CommandList& list, DeviceAddress source, DeviceAddress depth, DeviceAddress shaded,
                          std::uint64_t samples) const {
  const auto section = list.section("ground");
  list.dispatch(
      darken_, samples,
      shared::GroundArgs{.map = map_, .source = source, .depth = depth, .shaded = shaded, .shadow = shadow_.address()});
}

}  // namespace palpate
