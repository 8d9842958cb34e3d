#include "engine/render/panel_pass.hpp"

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "engine/gpu/transfer.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/near.hpp"

namespace palpate::panel_pass_test {

namespace {

using Color = std::array<double, 4>;

Color unpacked(std::uint32_t color) {
  Color result;
  for (std::size_t k = 0; k < 4; ++k) result[k] = (color >> 8 * k & 0xffu) / 255.0;
  return result;
}

struct Scene {
  std::vector<shared::PanelVertex> vertices;
  std::vector<shared::PanelTriangle> triangles;
  std::vector<Vec4> clips;
  std::vector<std::uint8_t> texture;
  UVec2 texture_px{0};

  PanelShapes shapes() const { return {vertices, triangles, clips}; }
  void add(const Vec4& clip, std::array<shared::PanelVertex, 3> corners) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    triangles.push_back({{first, first + 1, first + 2}, static_cast<std::uint32_t>(clips.size())});
    clips.push_back(clip);
    vertices.insert(vertices.end(), corners.begin(), corners.end());
  }
};

// Twice the signed area, in double precision.
double area(const Vec2& a, const Vec2& b, const DVec2& p) {
  return double(b.x - a.x) * (p.y - a.y) - double(b.y - a.y) * (p.x - a.x);
}

struct Reference {
  std::vector<Color> pixels;
  std::vector<bool> close;  // a pixel's centre so close to an edge that rounding decides
};

Reference reference(const Scene& scene, const UVec2& size_px, const std::vector<Color>& picture) {
  Reference result{picture, std::vector<bool>(picture.size(), false)};
  for (const shared::PanelTriangle& triangle : scene.triangles) {
    const auto& a = scene.vertices[triangle.vertices.x];
    const auto& b = scene.vertices[triangle.vertices.y];
    const auto& c = scene.vertices[triangle.vertices.z];
    const Vec4& clip = scene.clips[triangle.clip];
    for (std::uint32_t y = 0; y < size_px.y; ++y)
      for (std::uint32_t x = 0; x < size_px.x; ++x) {
        const DVec2 p(x + 0.5, y + 0.5);
        const std::size_t at = std::size_t{y} * size_px.x + x;
        if (p.x < clip.x || p.y < clip.y || p.x >= clip.z || p.y >= clip.w) continue;
        const DVec3 parts(area(b.place_px, c.place_px, p), area(c.place_px, a.place_px, p),
                          area(a.place_px, b.place_px, p));
        const double whole = parts.x + parts.y + parts.z;
        if (whole == 0 || !std::isfinite(whole)) continue;
        const DVec3 share = parts / whole;
        const double least = std::min({share.x, share.y, share.z});
        if (std::abs(least) < 1e-4) result.close[at] = true;
        if (least < 0) continue;
        Color color{};
        for (std::size_t k = 0; k < 4; ++k)
          color[k] = share.x * unpacked(a.color)[k] + share.y * unpacked(b.color)[k] + share.z * unpacked(c.color)[k];
        const DVec2 uv = share.x * DVec2(a.uv) + share.y * DVec2(b.uv) + share.z * DVec2(c.uv);
        const auto texel = [](double value, std::uint32_t count) {
          return std::min(static_cast<std::uint32_t>(std::max(value, 0.0) * count), count - 1);
        };
        const std::size_t from =
            std::size_t{texel(uv.y, scene.texture_px.y)} * scene.texture_px.x + texel(uv.x, scene.texture_px.x);
        const double alpha = color[3] * scene.texture[from] / 255.0;
        for (std::size_t k = 0; k < 3; ++k)
          result.pixels[at][k] = (1 - alpha) * result.pixels[at][k] + alpha * color[k];
      }
  }
  return result;
}

std::vector<std::uint32_t> drawn(Device& device, PanelPass& pass, const Scene& scene, const UVec2& size_px,
                                 const std::vector<std::uint32_t>& picture, std::uint32_t shrink, bool blueFirst,
                                 std::uint32_t background, std::uint64_t* layerThreads = nullptr) {
  const Buffer from = Buffer::of<std::uint32_t>(device, picture.size(), Memory::device, "picture");
  upload(device, from, picture);
  const std::uint64_t count = std::uint64_t{size_px.x} * size_px.y;
  const Buffer shown = Buffer::of<std::uint32_t>(device, count, Memory::device, "shown");
  CommandList list(device, device.throughputQueue(), "panels");
  list.begin();
  pass.record(list, picture.empty() ? nullptr : &from, shrink, scene.shapes(), size_px, shown, background, blueFirst);
  list.end();
  device.throughputQueue().run(list);
  if (layerThreads) {
    *layerThreads = 0;
    for (const PassRecord& each : list.passes())
      if (each.name == "render_panel_layer") *layerThreads += each.threads;
  }
  return download<std::uint32_t>(device, shown, count);
}

std::vector<std::uint32_t> drawn(Device& device, const Scene& scene, const UVec2& size_px,
                                 const std::vector<std::uint32_t>& picture, std::uint32_t shrink, bool blueFirst,
                                 std::uint32_t background) {
  PanelPass pass(device, scene.texture, scene.texture_px);
  return drawn(device, pass, scene, size_px, picture, shrink, blueFirst, background);
}

Scene randomScene(std::uint32_t seed, int triangles, const UVec2& size_px) {
  std::mt19937 random(seed);
  const auto number = [&](double low, double high) {
    return static_cast<float>(std::uniform_real_distribution(low, high)(random));
  };
  Scene scene;
  scene.texture_px = {1, 1};
  scene.texture = {255};
  for (int i = 0; i < triangles; ++i) {
    std::array<shared::PanelVertex, 3> corners;
    for (auto& corner : corners)
      corner = {
          {number(-10, size_px.x + 10.0), number(-10, size_px.y + 10.0)}, {0, 0}, static_cast<std::uint32_t>(random())};
    const float left = number(-5, size_px.x), top = number(-5, size_px.y);
    scene.add({left, top, left + number(1, size_px.x), top + number(1, size_px.y)}, corners);
  }
  return scene;
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "panels are blended as in double precision, at awkward sizes") {
  for (const UVec2 size_px : {UVec2(1, 1), UVec2(16, 16), UVec2(17, 15), UVec2(70, 33)}) {
    CAPTURE(size_px.x);
    const Scene scene = randomScene(size_px.x, 60, size_px);
    std::vector<std::uint32_t> picture(std::size_t{size_px.x} * size_px.y);
    std::vector<Color> before;
    for (std::uint32_t i = 0; i < picture.size(); ++i) {
      picture[i] = i * 2654435761u | 0xff000000u;
      before.push_back(unpacked(picture[i]));
    }
    const Reference truth = reference(scene, size_px, before);
    const auto got = drawn(device, scene, size_px, picture, 1, false, 0);
    std::size_t looked = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      if (truth.close[i]) continue;
      ++looked;
      for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(unpacked(got[i])[k] - truth.pixels[i][k]) < 1.5 / 255);
      CHECK_EQ(got[i] >> 24, 255u);
    }
    CHECK(looked > got.size() / 2);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "two triangles that share an edge leave no gap and cover no pixel twice") {
  const UVec2 size_px(64, 64);
  Scene scene;
  scene.texture_px = {1, 1};
  scene.texture = {255};
  const std::uint32_t half = 0x80ffffffu;  // white, blended with the background by halves
  const Vec4 all(0, 0, 64, 64);
  // A fan around a pixel's centre: edges in all directions, some through the centres of pixels.
  const Vec2 center(32.5f, 32.5f);
  constexpr int kParts = 16;
  const auto corner = [&](int i) {
    const double angle = 2 * std::numbers::pi * (i % kParts) / kParts;
    return Vec2(center.x + std::round(100 * std::cos(angle)), center.y + std::round(100 * std::sin(angle)));
  };
  for (int i = 0; i < kParts; ++i) {
    std::array<shared::PanelVertex, 3> corners{
        {{center, {0, 0}, half}, {corner(i), {0, 0}, half}, {corner(i + 1), {0, 0}, half}}};
    if (i % 2 == 0) std::swap(corners[1], corners[2]);  // both winding orders
    scene.add(all, corners);
  }
  const auto got = drawn(device, scene, size_px, {}, 1, false, 0xff000000u);
  for (const std::uint32_t pixel : got) CHECK_EQ(pixel & 0xff, 128u);
}

TEST_CASE_FIXTURE(GpuFixture, "glyphs come from the texture, texel by texel") {
  Scene scene;
  scene.texture_px = {5, 3};
  for (int i = 0; i < 15; ++i) scene.texture.push_back(static_cast<std::uint8_t>(17 * i));
  const Vec4 all(0, 0, 100, 100);
  const auto vertex = [](float x, float y) { return shared::PanelVertex{{2 + x, 4 + y}, {x / 5, y / 3}, 0xffffffffu}; };
  scene.add(all, {vertex(0, 0), vertex(5, 0), vertex(5, 3)});
  scene.add(all, {vertex(0, 0), vertex(5, 3), vertex(0, 3)});
  const auto got = drawn(device, scene, {20, 20}, {}, 1, false, 0xff000000u);
  for (std::uint32_t y = 0; y < 3; ++y)
    for (std::uint32_t x = 0; x < 5; ++x) CHECK_EQ(got[(4 + y) * 20 + 2 + x] & 0xff, 17 * (5 * y + x));
  CHECK(got[0] == 0xff000000u);
}

namespace {

/// Brightness as shaders/render/panel_compose.comp weighs it.
int brightnessOf(std::uint32_t rgba) {
  return static_cast<int>(2 * (rgba & 0xff) + 5 * (rgba >> 8 & 0xff) + (rgba >> 16 & 0xff));
}

double cross(const DVec2& a, const DVec2& b) { return a.x * b.y - a.y * b.x; }

/// A picture between the centres of its pixels, linear in the triangle that contains the position: by its barycentric
/// coordinates. A picture goes on beyond its border.
Color between(const std::vector<std::uint32_t>& picture, const UVec2& size_px, DVec2 at) {
  at = glm::clamp(at, DVec2(0), DVec2(size_px) - 1.0);
  const DVec2 low = glm::min(glm::floor(at), glm::max(DVec2(size_px) - 2.0, DVec2(0)));
  const auto pixel = [&](double x, double y) {
    const DVec2 place = glm::min(low + DVec2(x, y), DVec2(size_px) - 1.0);
    return picture[static_cast<std::size_t>(place.y) * size_px.x + static_cast<std::size_t>(place.x)];
  };
  const bool falls = std::abs(brightnessOf(pixel(0, 0)) - brightnessOf(pixel(1, 1))) <
                     std::abs(brightnessOf(pixel(1, 0)) - brightnessOf(pixel(0, 1)));
  const std::array<DVec2, 2> ends = falls ? std::array{DVec2(0, 0), DVec2(1, 1)} : std::array{DVec2(1, 0), DVec2(0, 1)};
  // The third corner is the one on the side of the diagonal where the position is.
  const DVec2 t = at - low,
              other = falls ? (t.x > t.y ? DVec2(1, 0) : DVec2(0, 1)) : (t.x + t.y < 1 ? DVec2(0, 0) : DVec2(1, 1));
  const double whole = cross(ends[1] - ends[0], other - ends[0]);
  const double third = cross(ends[1] - ends[0], t - ends[0]) / whole;
  const double second = cross(t - ends[0], other - ends[0]) / whole;
  Color color{};
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = (1 - second - third) * unpacked(pixel(ends[0].x, ends[0].y))[c] +
               second * unpacked(pixel(ends[1].x, ends[1].y))[c] + third * unpacked(pixel(other.x, other.y))[c];
  return color;
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "a smaller picture is interpolated linearly in triangles, at awkward sizes") {
  Scene none;
  none.texture_px = {1, 1};
  none.texture = {255};
  for (const UVec2 size_px : {UVec2(1, 1), UVec2(3, 3), UVec2(16, 7), UVec2(33, 18)})
    for (const std::uint32_t shrink : {1u, 2u, 3u}) {
      CAPTURE(size_px.x);
      CAPTURE(shrink);
      const UVec2 small_px = (size_px + (shrink - 1)) / shrink;
      std::vector<std::uint32_t> picture(std::size_t{small_px.x} * small_px.y);
      for (std::uint32_t i = 0; i < picture.size(); ++i) picture[i] = (i + 1) * 2654435761u | 0xff000000u;
      const auto shown = drawn(device, none, size_px, picture, shrink, false, 0);
      for (std::uint32_t i = 0; i < shown.size(); ++i) {
        const DVec2 at((i % size_px.x + 0.5) / shrink - 0.5, (i / size_px.x + 0.5) / shrink - 0.5);
        const Color expected = between(picture, small_px, at);
        for (std::size_t c = 0; c < 3; ++c) CHECK(unpacked(shown[i])[c] == within(expected[c], 1.01 / 255));
        if (shrink == 1) CHECK(shown[i] == picture[i]);
      }
    }
}

TEST_CASE_FIXTURE(GpuFixture, "a slanted edge in a smaller picture has no steps") {
  Scene none;
  none.texture_px = {1, 1};
  none.texture = {255};
  const UVec2 size_px(64, 64);
  for (const bool falls : {false, true}) {
    std::vector<std::uint32_t> picture;
    for (std::uint32_t i = 0; i < 32 * 32; ++i) {
      const std::uint32_t x = falls ? i % 32 : 31 - i % 32;
      picture.push_back(x > i / 32 ? 0xffffffffu : 0xff000000u);
    }
    const auto shown = drawn(device, none, size_px, picture, 2, false, 0);
    // Along the edge all pixels are the same.
    for (std::uint32_t off = 0; off < 4; ++off)
      for (std::uint32_t y = 8; y < 56; ++y) {
        const std::uint32_t x = falls ? y + off : 63 - y - off;
        CHECK((shown[y * 64 + x] & 0xff) == (shown[8 * 64 + (falls ? 8 + off : 55 - off)] & 0xff));
      }
    CHECK((shown[20 * 64 + 10] & 0xff) == (falls ? 0 : 255));
  }
}

TEST_CASE_FIXTURE(GpuFixture, "a picture without panels can have blue first") {
  Scene none;
  none.texture_px = {1, 1};
  none.texture = {255};
  const std::vector<std::uint32_t> picture{0xff0000ffu, 0xff00ff00u, 0xffff0000u, 0xff112233u};
  const auto swapped = drawn(device, none, {2, 2}, picture, 1, true, 0);
  CHECK(swapped == std::vector<std::uint32_t>{0xffff0000u, 0xff00ff00u, 0xff0000ffu, 0xff332211u});
}

TEST_CASE_FIXTURE(GpuFixture, "only the changed tiles of a panel are drawn again") {
  const UVec2 size_px(70, 33);  // five columns and three rows of tiles
  constexpr std::uint64_t kTile = shared::kPanelWorkgroup;
  std::vector<std::uint32_t> picture(std::size_t{size_px.x} * size_px.y, 0xff336699u);
  Scene scene = randomScene(3, 40, size_px);
  PanelPass pass(device, scene.texture, scene.texture_px);
  std::uint64_t threads = 0;
  const auto same = [&](const Scene& shown, const UVec2& px, std::uint32_t background = 0) {
    const auto& below = px == size_px ? picture : std::vector<std::uint32_t>{};
    CHECK(drawn(device, pass, shown, px, below, 1, false, background, &threads) ==
          drawn(device, shown, px, below, 1, false, background));
  };
  same(scene, size_px);
  CHECK(threads == 15 * kTile);
  same(scene, size_px);
  CHECK(threads == 0);
  picture.assign(picture.size(), 0xff998877u);  // the panels above it are unchanged
  same(scene, size_px);
  CHECK(threads == 0);

  const auto small = [](float x, std::uint32_t color) {
    return std::array<shared::PanelVertex, 3>{
        {{{x, 20}, {0, 0}, color}, {{x + 4, 20}, {0, 0}, color}, {{x, 24}, {0, 0}, color}}};
  };
  const Vec4 all(0, 0, 70, 33);
  scene.add(all, small(34, 0xff0000ffu));
  same(scene, size_px);
  CHECK(threads == kTile);
  scene.vertices[scene.vertices.size() - 2].color = 0xff00ff00u;
  same(scene, size_px);
  CHECK(threads == kTile);
  scene.clips.back() = {0, 0, 36, 33};
  same(scene, size_px);
  CHECK(threads == kTile);
  for (std::size_t k = 1; k <= 3; ++k)
    scene.vertices[scene.vertices.size() - k].place_px.x += 16;  // out of its clip rectangle
  same(scene, size_px);
  CHECK(threads == kTile);
  scene.clips.back() = all;
  same(scene, size_px);
  CHECK(threads == kTile);
  scene.add(all, small(2, 0x800000ffu));
  scene.add(all, small(2, 0x80ff0000u));
  same(scene, size_px);
  CHECK(threads == kTile);
  std::swap(scene.triangles.back(), scene.triangles[scene.triangles.size() - 2]);  // changes the drawing order
  same(scene, size_px);
  CHECK(threads == kTile);

  same(scene, {16, 16}, 0xff112233u);
  CHECK(threads == kTile);
  same(scene, {17, 16}, 0xff112233u);
  CHECK(threads == 2 * kTile);
  same(scene, size_px);
  CHECK(threads == 15 * kTile);
}

TEST_CASE("a triangle is in the tiles that it covers, not in its whole bounding box") {
  Scene scene;
  const auto vertex = [](float x, float y) { return shared::PanelVertex{{x, y}, {0, 0}, 0}; };
  const Vec4 all(0, 0, 160, 160);
  scene.add(all, {vertex(4, 2), vertex(158, 156), vertex(156, 158)});
  scene.add(all, {vertex(4, 2), vertex(156, 158), vertex(158, 156)});  // opposite winding order
  const PanelTiles tiles = tilesOf(scene.shapes(), {160, 160});
  for (std::size_t row = 0; row < 10; ++row)
    for (std::size_t column = 0; column < 10; ++column) {
      const std::uint32_t count = tiles.starts[10 * row + column + 1] - tiles.starts[10 * row + column];
      if (row == column) CHECK(count == 2);
      if (row > column + 1 || column > row + 1) CHECK(count == 0);
    }
}

TEST_CASE("triangles that are not finite, without area or outside their clip are in no tile") {
  Scene scene;
  const auto vertex = [](float x, float y) { return shared::PanelVertex{{x, y}, {0, 0}, 0}; };
  const Vec4 all(0, 0, 32, 32);
  scene.add(all, {vertex(NAN, 0), vertex(5, 0), vertex(5, 5)});
  scene.add(all, {vertex(3, 0), vertex(3, 8), vertex(3, 20)});
  scene.add({40, 40, 50, 50}, {vertex(0, 0), vertex(5, 0), vertex(5, 5)});
  scene.add({9, 9, 8, 8}, {vertex(0, 0), vertex(30, 0), vertex(30, 30)});
  CHECK(tilesOf(scene.shapes(), {32, 32}).entries.empty());
  scene.add(all, {vertex(0, 0), vertex(31, 0), vertex(31, 31)});
  const PanelTiles tiles = tilesOf(scene.shapes(), {32, 32});
  CHECK(tiles.entries == std::vector<std::uint32_t>{4, 4, 4, 4});
  CHECK(tiles.starts == std::vector<std::uint32_t>{0, 1, 2, 3, 4});
}

}  // namespace palpate::panel_pass_test
