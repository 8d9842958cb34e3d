#include "engine/render/panel_pass.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/core/checksum.hpp"
#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// The tiles that a triangle may cover: columns and rows, inclusive; empty if left > right.
struct TileBox {
  int left = 0, top = 0, right = -1, bottom = -1;
};

TileBox boxOf(const PanelShapes& shapes, const shared::PanelTriangle& triangle, const UVec2& size_px) {
  const Vec4& clip = shapes.clips[triangle.clip];
  Vec2 low(clip.x, clip.y), high(clip.z, clip.w);
  low = glm::max(low, Vec2(0));
  high = glm::min(high, Vec2(size_px));
  Vec2 least(INFINITY), most(-INFINITY);
  for (int k = 0; k < 3; ++k) {
    const Vec2 place = shapes.vertices[triangle.vertices[k]].place_px;
    if (!isFinite(place)) return {};
    least = glm::min(least, place);
    most = glm::max(most, place);
  }
  low = glm::max(low, least);
  high = glm::min(high, most);
  if (!(low.x < high.x && low.y < high.y)) return {};
  constexpr auto kTile = static_cast<float>(shared::kPanelTile_px);
  const auto tile = [](float place) { return static_cast<int>(std::floor(place / kTile)); };
  const IVec3 last((size_px.x - 1) / shared::kPanelTile_px, (size_px.y - 1) / shared::kPanelTile_px, 0);
  return {tile(low.x), tile(low.y), std::min(tile(high.x), last.x), std::min(tile(high.y), last.y)};
}

double cross(const DVec2& a, const DVec2& b) { return a.x * b.y - a.y * b.x; }

// Whether a triangle may contain the centre of a pixel of a tile: the tile, extended by half a pixel around those
// centres, is not entirely beyond one of the edges.
bool mayShow(const PanelShapes& shapes, const shared::PanelTriangle& triangle, int column, int row) {
  const auto corner = [&](int k) { return DVec2(shapes.vertices[triangle.vertices[k % 3]].place_px); };
  const double turn = cross(corner(1) - corner(0), corner(2) - corner(0)) < 0 ? -1 : 1;
  constexpr double kTile = shared::kPanelTile_px;
  for (int k = 0; k < 3; ++k) {
    const DVec2 from = corner(k), edge = turn * (corner(k + 1) - from);
    const DVec2 innermost((column + (edge.y > 0 ? 0 : 1)) * kTile, (row + (edge.x > 0 ? 1 : 0)) * kTile);
    if (cross(edge, innermost - from) < 0) return false;
  }
  return true;
}

template <class T>
void put(Device& device, Buffer& buffer, std::span<const T> values, const char* name) {
  if (buffer.bytes() < values.size_bytes())
    buffer = Buffer(device, 2 * values.size_bytes(), Memory::upload, name);  // room to grow
  if (!values.empty()) std::memcpy(buffer.mapped<std::byte>().data(), values.data(), values.size_bytes());
}

}  // namespace

PanelTiles tilesOf(const PanelShapes& shapes, const UVec2& size_px) {
  const UVec2 tiles = (size_px + (shared::kPanelTile_px - 1)) / shared::kPanelTile_px;
  PanelTiles result;
  result.starts.assign(std::size_t{tiles.x} * tiles.y + 1, 0);
  std::vector<TileBox> boxes;
  boxes.reserve(shapes.triangles.size());
  const auto forEachTile = [&](std::size_t i, auto&& visit) {
    const TileBox& box = boxes[i];
    for (int y = box.top; y <= box.bottom; ++y)
      for (int x = box.left; x <= box.right; ++x)
        if (mayShow(shapes, shapes.triangles[i], x, y))
          visit(static_cast<std::size_t>(y) * tiles.x + static_cast<std::size_t>(x));
  };
  for (const shared::PanelTriangle& triangle : shapes.triangles) {
    boxes.push_back(boxOf(shapes, triangle, size_px));
    forEachTile(boxes.size() - 1, [&](std::size_t tile) { ++result.starts[tile + 1]; });
  }
  for (std::size_t tile = 1; tile < result.starts.size(); ++tile) result.starts[tile] += result.starts[tile - 1];
  result.entries.resize(result.starts.back());
  std::vector<std::uint32_t> next(result.starts.begin(), result.starts.end() - 1);
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    forEachTile(i, [&](std::size_t tile) { result.entries[next[tile]++] = i; });
  return result;
}

std::vector<std::uint64_t> checksumsOf(const PanelShapes& shapes, const PanelTiles& tiles) {
  std::vector<std::uint64_t> ofTriangles, ofTiles;
  ofTriangles.reserve(shapes.triangles.size());
  for (const shared::PanelTriangle& triangle : shapes.triangles) {
    Checksum sum;
    for (int k = 0; k < 3; ++k) sum.add(std::as_bytes(shapes.vertices.subspan(triangle.vertices[k], 1)));
    sum.add(std::as_bytes(shapes.clips.subspan(triangle.clip, 1)));
    ofTriangles.push_back(sum.value());
  }
  ofTiles.reserve(tiles.starts.size());
  for (std::size_t tile = 0; tile + 1 < tiles.starts.size(); ++tile) {
    Checksum sum;
    for (std::uint32_t i = tiles.starts[tile]; i < tiles.starts[tile + 1]; ++i)
      sum.addValue(ofTriangles[tiles.entries[i]]);
    ofTiles.push_back(sum.value());
  }
  return ofTiles;
}

PanelPass::PanelPass(Device& device, std::span<const std::uint8_t> texture, const UVec2& texture_px)
    : device_(device),
      makeLayer_(device, shader_code::render_panel_layer,
                 {.workgroupSize = shared::kPanelWorkgroup, .pushBytes = sizeof(shared::PanelLayerArgs)}),
      compose_(device, shader_code::render_panel_compose, {.pushBytes = sizeof(shared::PanelComposeArgs)}),
      texture_(device, 0, Memory::upload, "panel texture"),
      vertices_(device, 0, Memory::upload, "panel vertices"),
      triangles_(device, 0, Memory::upload, "panel triangles"),
      clips_(device, 0, Memory::upload, "panel clips"),
      starts_(device, 0, Memory::upload, "panel tiles"),
      entries_(device, 0, Memory::upload, "panel entries"),
      tiles_(device, 0, Memory::upload, "panel tiles to make"),
      layer_(device, 0, Memory::device, "panel layer") {
  setTexture(texture, texture_px);
}

void PanelPass::setTexture(std::span<const std::uint8_t> texture, const UVec2& texture_px) {
  PALPATE_CHECK_EQ(texture.size(), std::size_t{texture_px.x} * texture_px.y);
  PALPATE_CHECK(!texture.empty());
  texture_px_ = texture_px;
  texture_ = Buffer(device_, (texture.size() + 3) / 4 * 4, Memory::upload, "panel texture");
  std::memcpy(texture_.mapped<std::byte>().data(), texture.data(), texture.size());
  made_.clear();
}

void PanelPass::record(CommandList& list, const Buffer* picture, std::uint32_t shrink, const PanelShapes& shapes,
                       const UVec2& size_px, const Buffer& shown, std::uint32_t background, bool blueFirst) {
  const std::uint64_t pixels = std::uint64_t{size_px.x} * size_px.y;
  PALPATE_CHECK_LE(sizeof(std::uint32_t) * pixels, shown.bytes());
  PALPATE_CHECK_LE(1u, shrink);
  const UVec2 picture_px = (size_px + (shrink - 1)) / shrink;
  if (picture) PALPATE_CHECK_LE(std::uint64_t{4} * picture_px.x * picture_px.y, picture->bytes());
  const auto section = list.section("panels");
  recordLayer(list, shapes, size_px);
  // The first one ends between the first two pixels of the picture.
  const UVec2 squares = (size_px + (shrink + 1) / 2 % shrink + (shrink - 1)) / shrink;
  list.dispatch(compose_, std::uint64_t{squares.x} * squares.y,
                shared::PanelComposeArgs{.picture = picture ? picture->address() : 0,
                                         .layer = layer_.address(),
                                         .shown = shown.address(),
                                         .size_px = size_px,
                                         .background = background,
                                         .blueFirst = blueFirst ? 1u : 0u,
                                         .shrink = shrink,
                                         .pictureWidth_px = picture_px.x,
                                         .squares = squares});
}

void PanelPass::recordLayer(CommandList& list, const PanelShapes& shapes, const UVec2& size_px) {
  if (size_px != layer_px_) {
    layer_ = Buffer::of<UVec2>(device_, std::uint64_t{size_px.x} * size_px.y, Memory::device, "panel layer");
    layer_px_ = size_px;
    made_.clear();
  }
  const PanelTiles tiles = tilesOf(shapes, size_px);
  std::vector<std::uint64_t> checksums = checksumsOf(shapes, tiles);
  std::vector<std::uint32_t> changed;
  for (std::uint32_t tile = 0; tile < checksums.size(); ++tile)
    if (made_.empty() || checksums[tile] != made_[tile]) changed.push_back(tile);
  made_ = std::move(checksums);
  put(device_, vertices_, shapes.vertices, "panel vertices");
  put(device_, triangles_, shapes.triangles, "panel triangles");
  put(device_, clips_, shapes.clips, "panel clips");
  put(device_, starts_, std::span<const std::uint32_t>(tiles.starts), "panel tiles");
  put(device_, entries_, std::span<const std::uint32_t>(tiles.entries), "panel entries");
  put(device_, tiles_, std::span<const std::uint32_t>(changed), "panel tiles to make");
  list.dispatch(makeLayer_, changed.size() * shared::kPanelWorkgroup,
                shared::PanelLayerArgs{.layer = layer_.address(),
                                       .vertices = vertices_.address(),
                                       .triangles = triangles_.address(),
                                       .clips = clips_.address(),
                                       .starts = starts_.address(),
                                       .entries = entries_.address(),
                                       .tiles = tiles_.address(),
                                       .texture = texture_.address(),
                                       .size_px = size_px,
                                       .texture_px = texture_px_,
                                       .tileCount = static_cast<std::uint32_t>(changed.size())});
}

}  // namespace palpate
