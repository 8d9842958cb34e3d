#include "engine/render/panel_pass.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// The tiles that a triangle may show in: columns and rows, the last ones included; none where a last one comes first.
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
  const auto forEachTile = [&](const TileBox& box, auto&& visit) {
    for (int y = box.top; y <= box.bottom; ++y)
      for (int x = box.left; x <= box.right; ++x)
        visit(static_cast<std::size_t>(y) * tiles.x + static_cast<std::size_t>(x));
  };
  for (const shared::PanelTriangle& triangle : shapes.triangles) {
    boxes.push_back(boxOf(shapes, triangle, size_px));
    forEachTile(boxes.back(), [&](std::size_t tile) { ++result.starts[tile + 1]; });
  }
  for (std::size_t tile = 1; tile < result.starts.size(); ++tile) result.starts[tile] += result.starts[tile - 1];
  result.entries.resize(result.starts.back());
  std::vector<std::uint32_t> next(result.starts.begin(), result.starts.end() - 1);
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    forEachTile(boxes[i], [&](std::size_t tile) { result.entries[next[tile]++] = i; });
  return result;
}

PanelPass::PanelPass(Device& device, std::span<const std::uint8_t> texture, const UVec2& texture_px)
    : device_(device),
      texture_px_(texture_px),
      panels_(device, shader_code::render_panels,
              {.workgroupSize = shared::kPanelWorkgroup, .pushBytes = sizeof(shared::PanelArgs)}),
      texture_(device, (texture.size() + 3) / 4 * 4, Memory::upload, "panel texture"),
      vertices_(device, 0, Memory::upload, "panel vertices"),
      triangles_(device, 0, Memory::upload, "panel triangles"),
      clips_(device, 0, Memory::upload, "panel clips"),
      starts_(device, 0, Memory::upload, "panel tiles"),
      entries_(device, 0, Memory::upload, "panel entries") {
  PALPATE_CHECK_EQ(texture.size(), std::size_t{texture_px.x} * texture_px.y);
  PALPATE_CHECK(!texture.empty());
  std::memcpy(texture_.mapped<std::byte>().data(), texture.data(), texture.size());
}

void PanelPass::record(CommandList& list, const Buffer* picture, std::uint32_t shrink, const PanelShapes& shapes,
                       const UVec2& size_px, const Buffer& shown, std::uint32_t background, bool blueFirst) {
  const std::uint64_t bytes = std::uint64_t{4} * size_px.x * size_px.y;
  PALPATE_CHECK_LE(bytes, shown.bytes());
  PALPATE_CHECK_LE(1u, shrink);
  const UVec2 picture_px = (size_px + (shrink - 1)) / shrink;
  if (picture) PALPATE_CHECK_LE(std::uint64_t{4} * picture_px.x * picture_px.y, picture->bytes());
  const PanelTiles tiles = tilesOf(shapes, size_px);
  put(device_, vertices_, shapes.vertices, "panel vertices");
  put(device_, triangles_, shapes.triangles, "panel triangles");
  put(device_, clips_, shapes.clips, "panel clips");
  put(device_, starts_, std::span<const std::uint32_t>(tiles.starts), "panel tiles");
  put(device_, entries_, std::span<const std::uint32_t>(tiles.entries), "panel entries");
  const auto section = list.section("panels");
  list.dispatch(panels_, (tiles.starts.size() - 1) * shared::kPanelWorkgroup,
                shared::PanelArgs{.picture = picture ? picture->address() : 0,
                                  .shown = shown.address(),
                                  .vertices = vertices_.address(),
                                  .triangles = triangles_.address(),
                                  .clips = clips_.address(),
                                  .starts = starts_.address(),
                                  .entries = entries_.address(),
                                  .texture = texture_.address(),
                                  .size_px = size_px,
                                  .texture_px = texture_px_,
                                  .background = background,
                                  .blueFirst = blueFirst ? 1u : 0u,
                                  .shrink = shrink,
                                  .pictureWidth_px = picture_px.x});
}

}  // namespace palpate
