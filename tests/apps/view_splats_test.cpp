// A splat scene in the window: cut out an object, touch it, export it as splats with all their harmonics.
#include "tests/apps/window_play.hpp"
#include "tests/says.hpp"
#include "tests/splat_files.hpp"

namespace palpate::test::view_splats_test {

namespace {

/// A ball at the origin, a smaller one beside it, the object, and sky far above both.
SplatFile twoBalls() {
  SplatFile scene = splatBall(3, 3000, {});
  const auto add = [&](const std::string& row, const DVec3& center) {
    scene.rows.push_back(row);
    const Vec3 single(center);
    std::memcpy(scene.rows.back().data(), &single, sizeof single);
  };
  const std::size_t ball = scene.rows.size();
  for (std::size_t i = 0; i < ball; ++i) add(scene.rows[i], DVec3(30, 0, 0) + 0.8 * scene.center(i));
  for (int i = 0; i < 20; ++i) add(scene.rows[static_cast<std::size_t>(i)], {5.0 * i - 40, 90, 3.0 * i});
  return scene;
}
constexpr std::size_t kBall = 3000;

}  // namespace

TEST_CASE(
    "an object is cut out of a splat scene, touched, exported and undone, and all else is the same byte by byte") {
  if (!hasDisplay()) return;
  const SplatFile scene = twoBalls();
  const auto played = playWell(
      "%/scene.ply --size 900x600 --rate 250 --edit push --backend cpu",
      [&](const auto& folder) { std::ofstream(folder / "scene.ply", std::ios::binary) << scene.bytes(); }, R"(
0.1 key s
0.2 key t
0.4 mouse 379 180
0.5 button left down
0.6 mouse 499 300
0.7 mouse 619 420
0.7 button left up
1.0 state %/selected.json
1.0 screenshot %/selected.png
1.1 export %/object.ply
1.6 key ctrl+i
1.8 key delete
2.2 state %/cut.json
2.3 save %/cut.ply
3.0 key 2
3.2 mouse 505 300
3.4 key space down
3.5 button left down
4.0 button left up
4.1 key space up
4.4 state %/touched.json
4.4 screenshot %/touched.png
4.5 save %/touched.ply
5.2 key ctrl+z
5.4 key ctrl+z
5.6 state %/undone.json
5.7 save %/undone.ply
6.3 quit
)");
  const auto saved = [&](const char* name) { return parsedSplats(contentOf(played->folder / name)); };
  const auto isOfObject = [](std::size_t row) { return row >= kBall && row < 2 * kBall; };
  for (const char* name : {"object.ply", "cut.ply"}) {
    CAPTURE(name);
    const SplatFile part = saved(name);
    CHECK(part.names == scene.names);
    const std::vector<std::size_t> rows = rowsIn(part, scene);
    CHECK(rows.size() == kBall);
    CHECK(std::ranges::all_of(rows, isOfObject));
  }
  CHECK(played->state("touched.json")["undo_count"] == 4);
  const SplatFile cut = saved("cut.ply"), touched = saved("touched.ply");
  const std::set<std::string> known(cut.rows.begin(), cut.rows.end());
  const auto same = std::ranges::count_if(touched.rows, [&](const std::string& row) { return known.contains(row); });
  CHECK(touched.names == scene.names);
  CHECK(same > 2000);
  CHECK(static_cast<std::size_t>(same) + 10 < touched.rows.size());
  // The harmonics of what was touched are those of the scene, rotated: as strong as before.
  const auto strength = [](const SplatFile& file, std::size_t row) {
    double squares = 0;
    for (int k = 0; k < 45; ++k) squares += std::pow(file.at(row, fmt::format("f_rest_{}", k)), 2);
    return squares;
  };
  std::set<long> strengths;
  for (std::size_t i = 0; i < cut.rows.size(); ++i) strengths.insert(std::lround(1e4 * strength(cut, i)));
  for (std::size_t i = 0; i < touched.rows.size(); ++i) {
    const long found = std::lround(1e4 * strength(touched, i));
    CHECK((strengths.contains(found) || strengths.contains(found - 1) || strengths.contains(found + 1)));
  }
  CHECK(played->state("undone.json")["undo_count"] == 2);
  CHECK(saved("undone.ply").rows == scene.rows);
}

TEST_CASE("a splat scene is saved in its own file after a question, as splats") {
  if (!hasDisplay()) return;
  const SplatFile scene = splatBall(2);
  const auto played = playWell(
      "%/scene.ply --size 480x360 --rate 250 --edit push --backend cpu",
      [&](const auto& folder) { std::ofstream(folder / "scene.ply", std::ios::binary) << scene.bytes(); }, R"(
0.1 mouse 132 180
0.3 key space down
0.4 button left down
0.9 button left up
1.0 key space up
1.4 ask
1.5 key ctrl+s
1.8 state %/asked.json
1.9 click Replace
2.8 state %/saved.json
3 quit
)");
  CHECK(says(played->state("asked.json").dump(), "scene.ply"));
  CHECK((contentOf(played->folder / "scene.ply.bak") == scene.bytes()));
  const SplatFile saved = parsedSplats(contentOf(played->folder / "scene.ply"));
  CHECK(saved.names == scene.names);
  CHECK(saved.rows != scene.rows);
}

TEST_CASE("a splat scene that moves is saved as the points of its present frame") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/scene.ply --size 480x360 --rate 250 --motion oscillate --backend cpu",
      [](const auto& folder) { std::ofstream(folder / "scene.ply", std::ios::binary) << splatBall(0, 500).bytes(); },
      "0.5 save %/moved.ply\n1.2 quit\n");
  const SplatFile moved = parsedSplats(contentOf(played->folder / "moved.ply"));
  REQUIRE(moved.names.size() > 5);
  CHECK(std::ranges::find(moved.names, "scale_0") == moved.names.end());
}

}  // namespace palpate::test::view_splats_test
