// Boxes, balls and planes that select in the window, and points that are moved by handles and by numbers.
#include <algorithm>
#include <cmath>

#include "engine/io/cloud_formats.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/content_of.hpp"
#include "tests/says.hpp"

namespace palpate::view_volume_test {

namespace {

constexpr const char* kSphere = "%/sphere.ply --size 900x600 --rate 250";

std::vector<double> numbersOf(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return c == ',' || c == ':'; }, ' ');
  std::istringstream words(text);
  std::vector<double> numbers;
  for (double number; words >> number;) numbers.push_back(number);
  return numbers;
}

PointCloud cloudOf(const Played& played, const char* name) { return readCloud(played.folder.path() / name).cloud; }

int selectedIn(const Played& played, const char* name) {
  return played.state(name)["selection"]["selected"].get<int>();
}

DVec2 handleIn(const Played& played, const char* name, std::size_t number) {
  const Result handle = played.state(name)["selection"]["handles"][number];
  return {handle[0].get<double>(), handle[1].get<double>()};
}

std::string drag(double time_s, const DVec2& from, const DVec2& to) {
  return fmt::format("{0:.1f} mouse {3} {4}\n{1:.1f} button left down\n{1:.1f} mouse {5} {6}\n{2:.1f} button left up\n",
                     time_s, time_s + 0.1, time_s + 0.2, from.x, from.y, to.x, to.y);
}

}  // namespace

TEST_CASE("a box is placed by a drag, and exactly the points in its numbers are selected, removed and restored") {
  if (!hasDisplay()) return;
  const auto played = playWell(kSphere, sphereOf(8000),
                               "0.1 key s\n0.15 key w\n0.2 state %/none.json\n" + drag(0.3, {349, 280}, {419, 280}) +
                                   R"(
1.0 state %/placed.json
1.1 save %/before.ply
1.2 key enter
1.4 state %/selected.json
1.5 key delete
1.7 save %/deleted.ply
1.8 key ctrl+z
2.0 save %/undone.ply
2.1 key escape
2.2 state %/removed.json
2.3 quit
)");
  CHECK(played->state("none.json")["selection"]["volume"] == "");
  CHECK(played->state("removed.json")["selection"]["volume"] == "");
  const std::vector<double> corner = numbersOf(played->state("placed.json")["selection"]["volume"].get<std::string>());
  REQUIRE(corner.size() == 6);
  const PointCloud before = cloudOf(*played, "before.ply"), left = cloudOf(*played, "deleted.ply");
  // The numbers are rounded: points at the very border count for neither.
  int inside = 0, near = 0;
  const auto depthOf = [&](const DVec3& p) {
    double depth = 1e9;
    for (int k = 0; k < 3; ++k)
      depth =
          std::min({depth, p[k] - corner[static_cast<std::size_t>(k)], corner[static_cast<std::size_t>(k) + 3] - p[k]});
    return depth;
  };
  const double slack = 1e-3 * (corner[3] - corner[0]);
  for (const Vec3& p : before.positions) {
    const double depth = depthOf(before.origin + DVec3(p));
    inside += depth > slack;
    near += std::abs(depth) <= slack;
  }
  const int selected = selectedIn(*played, "selected.json");
  CHECK(inside > 50);
  CHECK(selected >= inside);
  CHECK(selected <= inside + near);
  CHECK(static_cast<int>(left.size()) == 8000 - selected);
  CHECK(std::ranges::none_of(left.positions, [&](const Vec3& p) { return depthOf(left.origin + DVec3(p)) > slack; }));
  CHECK(contentOf(played->folder.path() / "undone.ply") == contentOf(played->folder.path() / "before.ply"));
}

TEST_CASE("a ball and a plane of typed numbers select what is in them, and the keys combine them") {
  if (!hasDisplay()) return;
  const auto played = playWell(kSphere, sphereOf(8000), R"(
0.1 key s
0.2 key d
0.3 volume 0,0,10:0,0,1
0.4 key enter
0.6 state %/above.json
0.7 click Other side
0.8 key shift+enter
1.0 state %/all.json
1.1 key shift+w
1.2 volume 0,0,50:20
1.3 key ctrl+enter
1.5 state %/less.json
1.6 save %/sphere2.ply
1.7 key ctrl+shift+enter
1.9 state %/nothing.json
2.0 quit
)");
  const PointCloud cloud = cloudOf(*played, "sphere2.ply");
  int above = 0, outside = 0;
  for (const Vec3& p : cloud.positions) {
    const DVec3 place = cloud.origin + DVec3(p);
    above += place.z >= 10;
    outside += glm::distance(place, DVec3(0, 0, 50)) > 20;
  }
  CHECK(std::abs(selectedIn(*played, "above.json") - above) <= 2);
  CHECK(selectedIn(*played, "all.json") == 8000);
  CHECK(std::abs(selectedIn(*played, "less.json") - outside) <= 2);
  CHECK(outside < 8000 - 100);
  CHECK(selectedIn(*played, "nothing.json") == 0);
}

TEST_CASE("numbers that do not describe a volume, and a missing volume, are refused by name") {
  if (!hasDisplay()) return;
  const auto errorOf = [](const char* key, const char* action) {
    const auto played =
        play(kSphere, fmt::format("0.1 key s\n0.2 key {}\n0.3 {}\n0.5 state %/s.json\n0.6 quit\n", key, action), "",
             sphereOf(500));
    const Result errors = played->state("s.json")["errors"];
    REQUIRE(errors.size() == 1);
    return errors[0].get<std::string>();
  };
  CHECK(says(errorOf("w", "volume 1,2,3"), "colon"));
  CHECK(says(errorOf("w", "volume 1,2:3,4,5"), "three numbers"));
  CHECK(says(errorOf("shift+w", "volume 1,2,3:-1"), "not a positive number"));
  CHECK(says(errorOf("shift+w", "volume 1,2,3:r"), "not a number"));
  CHECK(says(errorOf("d", "volume 1,2,3:0,0,0"), "length 0"));
  CHECK(says(errorOf("d", "key enter"), "there is no plane"));
  CHECK(says(errorOf("g", "move 1,0,0"), "no points are selected"));
  CHECK(says(errorOf("w", "move 1,0"), "three numbers"));
  CHECK(says(errorOf("r", "volume 1,2,3:4,5,6"), "choose box, ball or plane"));
}

TEST_CASE("selected points are moved by handles and by numbers, all others stay to the bit, and undo moves them back") {
  if (!hasDisplay()) return;
  const std::string begin = R"(
0.1 key s
0.2 key w
0.3 volume -60,-60,30:60,60,60
0.4 key enter
0.6 key g
0.8 state %/box.json
0.9 save %/before.ply
)";
  const auto first = playWell(kSphere, sphereOf(4000), begin + "1.0 quit\n");
  const std::size_t handles = first->state("box.json")["selection"]["handles"].size();
  REQUIRE(handles == 8);  // the centre, an arrow and a ring of each axis, and the size
  const DVec2 centre = handleIn(*first, "box.json", 0), arrow = handleIn(*first, "box.json", 5);
  const auto played = playWell(kSphere, sphereOf(4000), begin + drag(1.0, arrow, arrow + 0.5 * (arrow - centre)) + R"(
1.5 save %/dragged.ply
1.6 state %/dragged.json
1.7 key ctrl+z
1.9 save %/undone.ply
2.0 move 5,0,0 0,0,90 2
2.2 save %/numbers.ply
2.3 quit
)");
  const auto content = [&](const char* name) { return contentOf(played->folder.path() / name); };
  CHECK(content("undone.ply") == content("before.ply"));
  const PointCloud before = cloudOf(*played, "before.ply"), dragged = cloudOf(*played, "dragged.ply"),
                   numbers = cloudOf(*played, "numbers.ply");
  REQUIRE(dragged.size() == before.size());
  REQUIRE(numbers.size() == before.size());
  DVec3 low(1e9), high(-1e9);
  for (const Vec3& p : before.positions)
    if (p.z >= 30) {
      low = glm::min(low, DVec3(p));
      high = glm::max(high, DVec3(p));
    }
  const DVec3 middle = 0.5 * (low + high);
  int moved = 0, wrong = 0;
  double way = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Vec3 p = before.positions[i], to = dragged.positions[i], turned = numbers.positions[i];
    if (p.z < 30) {
      wrong += to != p || turned != p || dragged.normals[i] != before.normals[i];
      continue;
    }
    if (moved++ == 0) way = to.z - p.z;
    wrong += glm::distance(DVec3(to), DVec3(p) + DVec3(0, 0, way)) > 1e-4;
    const DVec3 arm = DVec3(p) - middle;
    wrong += glm::distance(DVec3(turned), middle + DVec3(5, 0, 0) + 2.0 * DVec3(-arm.y, arm.x, arm.z)) > 1e-3;
  }
  CHECK(wrong == 0);
  CHECK(moved > 500);
  CHECK(way > 5);
  CHECK(played->state("dragged.json")["errors"].empty());
}

TEST_CASE("hidden points are in no triangle, and the view is fitted to the points as they are") {
  if (!hasDisplay()) return;
  const auto played = playWell(std::string(kSphere) + " --resolution 32", sphereOf(2000), R"(
0.1 key s
0.2 key m
0.5 state %/whole.json
0.6 key d
0.7 volume 0,0,0:0,0,1
0.8 key enter
1.0 key h
1.3 state %/half.json
1.4 key shift+h
1.7 state %/again.json
1.8 key m
1.9 key ctrl+a
2.0 move 300,0,0
2.2 key home
2.4 state %/far.json
2.5 separate %/all.ply
2.7 state %/refused.json
2.8 quit
)");
  const auto triangles = [&](const char* name) { return played->state(name)["mesh_triangles"].get<double>(); };
  CHECK(triangles("whole.json") > 500);
  CHECK(triangles("half.json") < 0.7 * triangles("whole.json"));
  CHECK(triangles("half.json") > 0.3 * triangles("whole.json"));
  CHECK(triangles("again.json") == triangles("whole.json"));
  const Result target = played->state("far.json")["camera"]["target"];
  CHECK(std::abs(target[0].get<double>() - 300) < 20);
  CHECK(says(played->state("refused.json")["errors"][0].get<std::string>(), "at least one"));
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "all.ply"));
}

}  // namespace palpate::view_volume_test
