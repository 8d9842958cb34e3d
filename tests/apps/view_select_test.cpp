// Selecting in the window: what is drawn is selected, on the first surface, and what is done with it reaches the file.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

#include "engine/io/cloud_formats.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/content_of.hpp"
#include "tests/says.hpp"

namespace palpate::view_select_test {

namespace {

DVec3 eyeOf(const Result& state) {
  const auto& v = state["camera"]["eye"];
  return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

int selectedIn(const Played& played, const std::string& name) {
  return played.state(name)["selection"]["selected"].get<int>();
}

PointCloud cloudOf(const Played& played, const char* name) { return readCloud(played.folder.path() / name).cloud; }

// How often each position occurs.
std::map<std::array<float, 3>, int> positionsOf(const PointCloud& cloud) {
  std::map<std::array<float, 3>, int> positions;
  for (const Vec3& p : cloud.positions) ++positions[{p.x, p.y, p.z}];
  return positions;
}

/// Two sheets of 60 x 60 points, three spacings apart, seen from the side of +z, with two classes.
void makePlate(const std::filesystem::path& folder) {
  std::ofstream file(folder / "plate.ply");
  file << "ply\nformat ascii 1.0\nelement vertex 7200\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) file << "property float " << name << '\n';
  file << "property uchar classification\nend_header\n";
  for (const int up : {1, -1})
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x)
        file << x << ' ' << y << ' ' << 1.5 * up << " 0 0 " << up << ' ' << (x < 20 ? 2 : 5) << '\n';
}

// A rectangle over the whole model, which the panel does not cover.
std::string dragAll(double from_s) {
  return fmt::format(
      "{0:.1f} mouse 59 20\n{1:.1f} button left down\n{1:.1f} mouse 359 300\n{2:.1f} mouse 649 590\n"
      "{2:.1f} button left up\n",
      from_s, from_s + 0.2, from_s + 0.3);
}

constexpr const char* kSphere = "%/sphere.ply --size 900x600 --rate 250";

}  // namespace

TEST_CASE(
    "a rectangle takes the side of a ball that faces the eye; deleting it removes exactly that, and undo restores the "
    "file") {
  if (!hasDisplay()) return;
  const auto played = playWell(kSphere, sphereOf(8000), "0.1 key s\n" + dragAll(0.2) + R"(
1.0 state %/selected.json
1.1 save %/before.ply
2.0 key delete
2.2 state %/deleted.json
2.3 save %/deleted.ply
3.0 key ctrl+z
3.2 state %/undone.json
3.3 save %/undone.ply
4.0 quit
)");
  const Result selected = played->state("selected.json"), deleted = played->state("deleted.json");
  const int count = selectedIn(*played, "selected.json");
  CHECK(selected["mouse"] == "selecting");
  CHECK(deleted["points"] == 8000 - count);
  CHECK(deleted["selection"]["selected"] == 0);
  CHECK(says(deleted["last_message"].get<std::string>(), fmt::format("{} points removed", count)));
  CHECK(selectedIn(*played, "undone.json") == count);
  CHECK(played->state("undone.json")["points"] == 8000);
  const auto content = [&](const char* name) { return contentOf(played->folder.path() / name); };
  CHECK(content("undone.ply") == content("before.ply"));
  // Against the analytic ball: nothing of the far side, and all of the near side but for the very rim.
  const PointCloud before = cloudOf(*played, "before.ply");
  const auto left = positionsOf(cloudOf(*played, "deleted.ply"));
  const DVec3 eye = eyeOf(selected);
  int front = 0, wrong = 0, missed = 0, removed = 0;
  for (const Vec3& p : before.positions) {
    const bool isGone = !left.contains({p.x, p.y, p.z});
    const double cosine = glm::dot(glm::normalize(DVec3(p)), glm::normalize(eye - DVec3(p)));
    removed += isGone;
    front += cosine > 0;
    wrong += isGone && cosine < 0;
    missed += !isGone && cosine > 0.1;
  }
  CHECK(removed == count);
  CHECK(wrong == 0);
  CHECK(missed == 0);
  CHECK(count > 0.97 * front);
}

TEST_CASE("of a thin plate only the near sheet is selected, and through it both") {
  if (!hasDisplay()) return;
  const auto played =
      playWell("%/plate.ply --size 900x600 --rate 250 --up y", makePlate,
               "0.1 key ctrl+1\n0.2 key s\n" + dragAll(0.3) + "0.9 state %/near.json\n1.0 export %/near.ply\n" +
                   "1.1 key t\n" + dragAll(1.2) + "1.9 state %/through.json\n" + "2.0 key t\n2.1 key ctrl+2\n" +
                   dragAll(2.2) + "3.0 export %/far.ply\n3.5 quit\n");
  CHECK(selectedIn(*played, "near.json") == 3600);
  CHECK(played->state("near.json")["selection"]["through"] == false);
  CHECK(selectedIn(*played, "through.json") == 7200);
  for (const char* name : {"near.ply", "far.ply"}) {
    const PointCloud part = cloudOf(*played, name);
    CHECK(part.size() == 3600);
    CHECK(std::ranges::all_of(part.positions, [&](const Vec3& p) { return p.z == part.positions[0].z; }));
  }
  CHECK(cloudOf(*played, "near.ply").positions[0].z == -cloudOf(*played, "far.ply").positions[0].z);
}

TEST_CASE(
    "a polygon loses corners with Backspace and Alt, closes with Enter or the right button, and Esc gives it up") {
  if (!hasDisplay()) return;
  const auto click = [](double at_s, int x, int y) {
    return fmt::format("{0:.2f} mouse {1} {2}\n{0:.2f} button left down\n{0:.2f} button left up\n", at_s, x, y);
  };
  std::string script = "0.1 key s\n0.15 key p\n";
  // The left half of the picture, after two wrong corners.
  script +=
      click(0.2, 59, 10) + click(0.4, 347, 10) + click(0.6, 639, 300) + "0.8 key backspace\n" + click(0.9, 649, 310);
  script += "1.1 key alt down\n" + click(1.15, 650, 311) + "1.3 key alt up\n";
  script +=
      click(1.4, 347, 570) + click(1.6, 59, 570) + "1.8 state %/drawn.json\n1.9 key enter\n2.0 state %/left.json\n";
  // The right half is added, closed by the right button.
  script += "2.1 key shift down\n" + click(2.2, 347, 10) + "2.4 key shift up\n" + click(2.5, 649, 10) +
            click(2.7, 649, 570) + click(2.9, 347, 570) +
            "3.1 button right down\n3.1 button right up\n3.3 state %/both.json\n";
  // Given up; then all corners are taken back.
  script +=
      click(3.4, 59, 10) + click(3.6, 347, 10) + click(3.8, 347, 570) + "4.0 key escape\n4.1 state %/given_up.json\n";
  script += click(4.2, 59, 10) + "4.4 key backspace\n4.5 key backspace\n4.6 state %/none_left.json\n";
  // Ctrl removes, both keep what is in both.
  script += "4.7 key r\n4.8 key ctrl down\n" +
            std::string("4.9 mouse 347 10\n5.0 button left down\n5.1 mouse 649 590\n") +
            "5.2 button left up\n5.3 key ctrl up\n5.4 state %/removed.json\n";
  script += "5.5 key ctrl down\n5.5 key shift down\n5.6 mouse 59 10\n5.7 button left down\n5.8 mouse 649 300\n";
  script += "5.9 button left up\n6.0 key shift up\n6.0 key ctrl up\n6.1 state %/quarter.json\n6.2 quit\n";
  const auto played = playWell(kSphere, sphereOf(8000), script);
  CHECK(played->state("drawn.json")["selection"]["drawn"] == true);
  CHECK(played->state("left.json")["selection"]["drawn"] == false);
  const int left = selectedIn(*played, "left.json"), both = selectedIn(*played, "both.json");
  CHECK(both > 2600);
  CHECK(std::abs(left - both / 2) < 100);
  CHECK(played->state("given_up.json")["selection"]["drawn"] == false);
  CHECK(selectedIn(*played, "given_up.json") == both);
  CHECK(played->state("none_left.json")["selection"]["drawn"] == false);
  CHECK(selectedIn(*played, "none_left.json") == both);
  CHECK(played->state("none_left.json")["forces_on"] == true);
  CHECK(std::abs(selectedIn(*played, "removed.json") - left) < 3);
  CHECK(std::abs(selectedIn(*played, "quarter.json") - left / 2) < 150);
}

TEST_CASE("a lasso takes what it surrounds, moves while Space is held, and the camera stays as it was") {
  if (!hasDisplay()) return;
  std::string script = "0.05 state %/begin.json\n0.1 key s\n0.15 key l\n0.2 mouse 259 300\n0.4 button left down\n";
  const auto around = [&](double from_s, int x) {
    std::string text;
    for (int k = 1; k <= 12; ++k)
      text += fmt::format("{:.2f} mouse {:.0f} {:.0f}\n", from_s + 0.05 * k, x + 60 * std::cos(k * 0.5236) - 60,
                          300 + 60 * std::sin(k * 0.5236));
    return text;
  };
  script += around(0.4, 259) + "1.1 button left up\n1.2 state %/lasso.json\n1.3 export %/lasso.ply\n";
  script += "1.5 mouse 259 300\n1.7 button left down\n" + around(1.7, 259) +
            "2.4 key space down\n2.5 mouse 409 300\n2.6 key space up\n2.7 state %/moved.json\n2.8 button left up\n" +
            "3.0 export %/moved.ply\n3.2 state %/end.json\n3.3 quit\n";
  const auto played = playWell(kSphere, sphereOf(8000), script);
  const PointCloud lasso = cloudOf(*played, "lasso.ply"), moved = cloudOf(*played, "moved.ply");
  CHECK(lasso.size() == static_cast<std::size_t>(selectedIn(*played, "lasso.json")));
  CHECK(lasso.size() > 60);
  CHECK(played->state("moved.json")["stylus"] == false);
  CHECK(moved.size() > 60);
  const auto middle = [](const PointCloud& cloud) {
    double sum = 0;
    for (const Vec3& p : cloud.positions) sum += double{p.x};
    return sum / static_cast<double>(cloud.size());
  };
  // Front view: to the left of the middle, and then to the right.
  CHECK(middle(moved) - middle(lasso) > 15);
  CHECK(played->state("end.json")["camera"]["eye"].dump() == played->state("begin.json")["camera"]["eye"].dump());
}

TEST_CASE("a brush, a flood, growing, shrinking, inverting and hiding select what they promise") {
  if (!hasDisplay()) return;
  const auto played = playWell(kSphere, sphereOf(8000), R"(
0.1 key s
0.2 key b
0.3 mouse 299 300
0.5 button left down
0.6 mouse 339 300
0.7 mouse 399 300
0.8 button left up
0.9 state %/brushed.json
1.0 key ]
1.1 key +
1.2 state %/grown.json
1.3 key -
1.4 state %/shrunk.json
1.5 key ctrl+i
1.6 state %/inverted.json
1.7 key ctrl+shift+a
1.8 state %/none.json
1.9 key o
2.0 mouse 347 300
2.2 button left down
2.2 button left up
2.4 state %/flooded.json
2.5 export %/flooded.ply
2.6 key j
2.8 state %/connected.json
2.9 key ctrl+z
3.0 key h
3.2 state %/hidden.json
3.3 mouse 459 500
3.4 button right down
3.5 mouse 519 520
3.6 button right up
3.7 state %/turned.json
3.8 key ctrl+a
3.9 state %/shown.json
4.0 key shift+h
4.1 state %/all_shown.json
4.2 key ctrl+z
4.3 key ctrl+z
4.4 key ctrl+z
4.5 state %/undone.json
4.6 key i
4.8 state %/isolated.json
4.9 quit
)");
  const int brushed = selectedIn(*played, "brushed.json"), flooded = selectedIn(*played, "flooded.json");
  CHECK(brushed > 40);
  CHECK(brushed < 600);
  CHECK(played->state("grown.json")["selection"]["brush_mm"] > played->state("brushed.json")["selection"]["brush_mm"]);
  CHECK(selectedIn(*played, "grown.json") > brushed + 20);
  CHECK(std::abs(selectedIn(*played, "shrunk.json") - brushed) < brushed / 4);
  CHECK(selectedIn(*played, "inverted.json") == 8000 - selectedIn(*played, "shrunk.json"));
  CHECK(selectedIn(*played, "none.json") == 0);
  // A cap of 15 degrees around the clicked point: (1 - cos 15) / 2 of the ball.
  CHECK(std::abs(flooded - 8000 * (1 - std::cos(0.2618)) / 2) < 15);
  CHECK(selectedIn(*played, "connected.json") == 8000);
  const Result hidden = played->state("hidden.json");
  CHECK(hidden["selection"]["hidden"] == flooded);
  CHECK(hidden["selection"]["selected"] == 0);
  CHECK(says(hidden["notices"].dump(), fmt::format("{} points are hidden", flooded)));
  CHECK(played->state("turned.json")["camera"]["eye"].dump() != hidden["camera"]["eye"].dump());
  CHECK(played->state("turned.json")["selection"]["hidden"] == flooded);
  CHECK(selectedIn(*played, "shown.json") == 8000 - flooded);
  CHECK(played->state("all_shown.json")["selection"]["hidden"] == 0);
  CHECK(selectedIn(*played, "undone.json") == flooded);
  CHECK(played->state("isolated.json")["selection"]["hidden"] == 8000 - flooded);
  CHECK(selectedIn(*played, "isolated.json") == flooded);
}

TEST_CASE("a class that is set to the selected points is in the saved LAS file, and all else is as it was") {
  if (!hasDisplay()) return;
  const auto prepare = [](const std::filesystem::path& folder) {
    makePlate(folder);
    works("--quiet convert " + (folder / "plate.ply").string() + " " + (folder / "plate.las").string());
  };
  const auto played = playWell("%/plate.las --size 900x600 --rate 250 --up y", prepare,
                               "0.1 key ctrl+1\n0.1 save %/before.las\n1.0 key s\n" + dragAll(1.1) + R"(
1.8 state %/selected.json
1.9 value classification 6
2.0 value classification 300
2.1 state %/refused.json
2.2 save %/classes.las
3.0 key e
3.1 mouse 347 300
3.2 key ctrl+shift+a
3.4 button left down
3.4 button left up
3.6 state %/same.json
3.7 key ctrl+z
3.7 key ctrl+z
3.8 value weight 2.5
3.9 save %/weights.ply
4.5 quit
)");
  CHECK(selectedIn(*played, "selected.json") == 3600);
  CHECK(says(played->state("refused.json")["errors"].dump(), "'300' is not a whole number from 0 to 255"));
  const PointCloud before = cloudOf(*played, "before.las"), after = cloudOf(*played, "classes.las");
  CHECK(after.positions == before.positions);
  REQUIRE(after.extra.size() == before.extra.size());
  std::size_t classes = 0;
  for (std::size_t k = 0; k < after.extra.size(); ++k) {
    if (after.extra[k].name != "classification") CHECK(after.extra[k].data == before.extra[k].data);
    if (after.extra[k].name != "classification") continue;
    REQUIRE(after.extra[k].data.size() == 7200);
    for (std::size_t i = 0; i < 7200; ++i) {
      const bool isNear = after.positions[i].z == after.positions[0].z;
      classes += after.extra[k].data[i] == (isNear ? std::byte{6} : before.extra[k].data[i]);
    }
  }
  CHECK(classes == 7200);
  CHECK(selectedIn(*played, "same.json") == 3600);
  const PointCloud weighted = cloudOf(*played, "weights.ply");
  const auto weight = std::ranges::find(weighted.extra, "weight", &Attribute::name);
  REQUIRE(weight != weighted.extra.end());
  std::size_t weights = 0;
  for (std::size_t i = 0; i < 7200; ++i) weights += loadScalar<float>(weight->data, 4 * i) == 2.5f;
  CHECK(weights == 3600);
}

TEST_CASE("selected points are exported and separated with all that the file has of them, but not over the open file") {
  if (!hasDisplay()) return;
  const auto played =
      playWell(kSphere, sphereOf(2000), "0.1 key s\n0.2 export %/none.ply\n0.3 state %/none.json\n" + dragAll(0.4) + R"(
1.0 state %/selected.json
1.1 export %/sphere.ply
1.2 state %/refused.json
1.3 export %/part.ply
1.5 separate %/separated.ply
1.8 state %/left.json
1.9 save %/left.ply
2.5 key ctrl+a
2.6 key delete
2.7 state %/all.json
2.8 quit
)");
  const auto count = static_cast<std::size_t>(selectedIn(*played, "selected.json"));
  CHECK(says(played->state("none.json")["errors"].dump(), "no points are selected"));
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "none.ply"));
  CHECK(says(played->state("refused.json")["errors"].dump(), "is the file of the open model"));
  const PointCloud whole = cloudOf(*played, "sphere.ply"), part = cloudOf(*played, "part.ply"),
                   left = cloudOf(*played, "left.ply");
  CHECK(whole.size() == 2000);
  CHECK(part.size() == count);
  CHECK(left.size() == 2000 - count);
  CHECK(contentOf(played->folder.path() / "part.ply") == contentOf(played->folder.path() / "separated.ply"));
  auto both = positionsOf(part);
  for (const auto& [position, times] : positionsOf(left)) both[position] += times;
  CHECK(both == positionsOf(whole));
  CHECK(says(played->state("all.json")["errors"].dump(), "a model needs at least one"));
  CHECK(played->state("all.json")["points"] == 2000 - count);
}

TEST_CASE("locked points are neither removed nor coloured with the others") {
  if (!hasDisplay()) return;
  const auto played = playWell(kSphere, sphereOf(2000), "0.1 key s\n" + dragAll(0.2) + R"(
1.0 click Lock
1.5 key ctrl+a
1.7 click Colour
2.0 save %/coloured.ply
2.8 key delete
3.0 state %/removed.json
3.1 key delete
3.2 state %/refused.json
3.3 click Unlock all
3.6 state %/unlocked.json
3.7 quit
)");
  const Result removed = played->state("removed.json");
  const int locked = removed["selection"]["locked"];
  CHECK(locked > 600);
  CHECK(removed["points"] == locked);
  const PointCloud coloured = cloudOf(*played, "coloured.ply");
  REQUIRE(coloured.colors.size() == 2000);
  const std::array<std::uint8_t, 4> red{220, 40, 40, 255};
  CHECK(std::ranges::count(coloured.colors, red) == 2000 - locked);
  CHECK(says(played->state("refused.json")["errors"].dump(), "all selected points are locked"));
  CHECK(played->state("unlocked.json")["selection"]["locked"] == 0);
}

TEST_CASE("each tool has its keys: S selects and goes back, V only looks, a number sculpts") {
  if (!hasDisplay()) return;
  const auto played = playWell(kSphere, sphereOf(2000), R"(
0.1 state %/begin.json
0.2 key s
0.3 key space down
0.4 state %/space.json
0.5 key space up
0.6 key r
0.7 key h
0.8 state %/selecting.json
0.9 key s
1.0 state %/back.json
1.1 key v
1.2 key space down
1.3 mouse 347 300
1.5 state %/looking.json
1.6 key space up
1.7 key 3
1.8 state %/carving.json
1.9 key t
2.0 state %/stylus.json
2.1 key s
2.3 state %/put_away.json
2.4 click Only look
2.5 state %/clicked.json
2.6 click Select
2.7 click lasso
2.8 state %/lasso.json
2.9 key d
3.0 state %/no_measure.json
3.1 quit
)");
  const auto tool = [&](const char* name) { return played->state(name)["mouse"].get<std::string>(); };
  CHECK(tool("begin.json") == "sculpting");
  CHECK(tool("space.json") == "selecting");
  CHECK(played->state("space.json")["stylus"] == false);
  CHECK(played->state("selecting.json")["camera"]["eye"].dump() == played->state("begin.json")["camera"]["eye"].dump());
  CHECK(says(played->state("selecting.json")["errors"].dump(), "no points are selected"));
  CHECK(tool("back.json") == "sculpting");
  CHECK(tool("looking.json") == "looking");
  CHECK(played->state("looking.json")["stylus"] == false);
  CHECK(tool("carving.json") == "sculpting");
  CHECK(played->state("carving.json")["tool"] == "carve");
  CHECK(played->state("stylus.json")["stylus"] == true);
  CHECK(played->state("put_away.json")["stylus"] == false);
  CHECK(tool("clicked.json") == "looking");
  CHECK(played->state("lasso.json")["selection"]["shape"] == "lasso");
  CHECK(played->state("no_measure.json")["measuring"] == false);
}

TEST_CASE("a moving model says why its points cannot be selected") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 900x600 --rate 250 --motion oscillate", sphereOf(2000),
                               "0.1 key s\n" + dragAll(0.2) + "1.0 state %/refused.json\n1.1 key ctrl+a\n1.2 quit\n");
  CHECK(says(played->state("refused.json")["errors"].dump(), "points of a moving model cannot be selected"));
  CHECK(selectedIn(*played, "refused.json") == 0);
}

}  // namespace palpate::view_select_test
