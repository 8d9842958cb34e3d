// Layers of strokes in the window: begun by key and button, slid by the panel and by a script, one drag an entry.
#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "engine/io/ply_reader.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_layers_test {

namespace {

// From `begin_s` on, 1.5 s long.
std::string stroke(double begin_s, int y) {
  std::string script;
  const auto add = [&](double after_s, const std::string& event) {
    script += fmt::format("{} {}\n", begin_s + after_s, event);
  };
  add(0, fmt::format("mouse 310 {}", y));
  add(0.1, "key space down");
  add(0.3, "button left down");
  for (int i = 0; i < 8; ++i) add(0.4 + 0.05 * i, fmt::format("mouse {} {}", 315 + 6 * i, y));
  add(0.9, "button left up");
  add(1.4, "key space up");
  return script;
}

std::vector<Vec3> placesIn(const Played& played, const char* file) {
  std::vector<Vec3> places = readPly(played.folder / file).positions;
  std::ranges::sort(places,
                    [](const Vec3& a, const Vec3& b) { return std::tuple(a.x, a.y, a.z) < std::tuple(b.x, b.y, b.z); });
  return places;
}

}  // namespace

TEST_CASE("a user slides the strokes of a layer by its slider, hides them, and undoes a drag as one change") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 900x600 --backend cpu --edit inflate", sphereOf(),
                               "0.1 save %/plain.ply\n0.3 key l\n0.4 state %/open.json\n" + stroke(0.5, 290) + R"(
2.1 click End layer
2.3 state %/made.json
2.4 save %/made.ply
2.6 click layer 1
2.9 state %/half.json
3.0 button left down
3.1 mouse 899 290
3.2 mouse 850 290
3.3 mouse 0 290
3.4 button left up
3.6 state %/zero.json
3.7 save %/zero.ply
3.9 key ctrl+z
4.1 state %/back.json
4.2 key ctrl+z
4.4 save %/again.ply
4.6 click show layer 1
4.8 state %/hidden.json
4.9 save %/hidden.ply
5.1 quit
)");
  const auto layer = [&](const char* state) { return played->state(state)["layers"].front(); };
  const auto changes = [&](const char* state) { return played->state(state)["undo_count"].get<int>(); };
  CHECK(layer("open.json")["open"] == true);
  CHECK(layer("made.json")["open"] == false);
  CHECK(layer("made.json")["strength"] == 1);
  CHECK(layer("made.json")["points"].get<int>() > 20);
  CHECK(layer("half.json")["strength"].get<double>() == within(0.5, 0.1));
  CHECK(changes("half.json") == changes("made.json") + 1);
  CHECK(layer("zero.json")["strength"] == 0);
  CHECK(changes("zero.json") == changes("made.json") + 2);
  CHECK(layer("back.json")["strength"] == layer("half.json")["strength"]);
  CHECK(layer("hidden.json")["hidden"] == true);
  CHECK(layer("hidden.json")["strength"] == 1);
  const std::vector<Vec3> plain = placesIn(*played, "plain.ply"), made = placesIn(*played, "made.ply");
  CHECK(made != plain);
  CHECK(placesIn(*played, "zero.ply") == plain);
  CHECK(placesIn(*played, "again.ply") == made);
  CHECK(placesIn(*played, "hidden.ply") == plain);
}

TEST_CASE(
    "a script makes layers by name, slides them to any strength, opens and merges them, and is told of mistakes") {
  if (!hasDisplay()) return;
  const auto played =
      playWell("%/sphere.ply --size 900x600 --backend cpu --edit inflate", sphereOf(),
               "0.1 layer new skin of the neck\n" + stroke(0.3, 290) + "1.9 layer new deep\n" + stroke(2, 250) + R"(
3.6 layer -0.5 skin of the neck
3.7 state %/slid.json
3.8 layer open skin of the neck
3.9 state %/open.json
4.0 layer merge deep
4.1 state %/merged.json
4.2 layer 0.5 deep
4.4 state %/none.json
4.5 layer close
4.6 layer 0.25
4.7 state %/unnamed.json
4.8 quit
)");
  const Result slid = played->state("slid.json")["layers"];
  REQUIRE(slid.size() == 2);
  CHECK(slid.front()["strength"] == -0.5);
  CHECK(slid.back()["open"] == true);
  CHECK(slid.back()["points"].get<int>() > 20);
  const Result open = played->state("open.json")["layers"];
  CHECK(open.front()["strength"] == 1);
  CHECK(open.front()["open"] == true);
  CHECK(open.back()["open"] == false);
  CHECK(played->state("merged.json")["layers"].size() == 1);
  CHECK(says(played->state("none.json")["errors"].dump(), "no layer of strokes named deep"));
  const Result unnamed = played->state("unnamed.json")["layers"];  // the newest that is left
  CHECK(unnamed.front()["strength"] == 0.25);
  CHECK(unnamed.front()["open"] == false);
}

}  // namespace palpate::view_layers_test
