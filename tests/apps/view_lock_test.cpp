// Locks with soft rims in the window.
#include <algorithm>
#include <array>

#include "engine/io/cloud_formats.hpp"
#include "tests/apps/window_play.hpp"

namespace palpate::view_lock_test {

TEST_CASE("a lock with a soft rim is inverted, sharpened, undone step by step, and saved with the model") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 900x600 --rate 250", sphereOf(2000), R"(
0.1 key s
0.2 mouse 59 20
0.4 button left down
0.4 mouse 359 300
0.5 mouse 649 590
0.5 button left up
1.0 key ctrl+m
1.2 state %/hard.json
1.4 click Soften lock
1.9 state %/soft.json
2.0 save %/soft.ply
2.6 click Invert lock
3.1 save %/inverted.ply
3.7 click Sharpen lock
4.2 state %/sharp.json
4.3 key ctrl+z
4.5 key ctrl+z
4.7 key ctrl+z
4.9 state %/undone.json
5.0 key ctrl+shift+m
5.2 state %/free.json
5.3 quit
)");
  const auto counts = [&](const char* name) {
    const auto selection = played->state(name)["selection"];
    return std::array{selection["locked"].get<int>(), selection["locked_in_part"].get<int>()};
  };
  const auto hard = counts("hard.json"), soft = counts("soft.json"), sharp = counts("sharp.json");
  CHECK(hard[0] > 600);
  CHECK(hard[1] == 0);
  CHECK(soft[0] > hard[0] + 30);
  CHECK(soft[1] > 30);
  CHECK(soft[0] - soft[1] == hard[0]);  // what is locked wholly stays so
  CHECK(sharp[1] < soft[1]);
  CHECK(counts("undone.json") == hard);
  CHECK(counts("free.json") == std::array{0, 0});
  const auto weightsIn = [&](const char* name) {
    const PointCloud cloud = readCloud(played->folder.path() / name).cloud;
    const auto lock = std::ranges::find(cloud.extra, "lock", &Attribute::name);
    REQUIRE(lock != cloud.extra.end());
    std::vector<int> weights;
    for (const std::byte weight : lock->data) weights.push_back(std::to_integer<int>(weight));
    return weights;
  };
  const std::vector<int> weights = weightsIn("soft.ply"), inverse = weightsIn("inverted.ply");
  REQUIRE(weights.size() == 2000);
  CHECK(std::ranges::count(weights, 0) == 2000 - soft[0]);
  for (std::size_t i = 0; i < weights.size(); ++i) CHECK(weights[i] + inverse[i] == 255);
}

TEST_CASE("a brush locks what it passes over, with its falloff, and with Ctrl it frees that, each undone at once") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 900x600 --rate 250", sphereOf(4000), R"(
0.1 key s
0.2 key shift+b
0.22 click falloff
0.26 click sphere
0.3 mouse 320 250
0.5 button left down
0.6 mouse 380 300
0.7 button left up
1.0 state %/soft.json
1.1 screenshot %/soft.png
1.2 key ctrl+z
1.4 state %/undone.json
1.5 click falloff
1.7 click flat
1.9 mouse 320 250
2.1 button left down
2.2 mouse 380 300
2.3 button left up
2.5 state %/flat.json
2.6 key ctrl down
2.7 mouse 350 275
2.8 button left down
2.9 button left up
3.0 key ctrl up
3.2 state %/freed.json
3.3 quit
)");
  const auto count = [&](const char* name, const char* key) {
    return played->state(name)["selection"][key].get<int>();
  };
  CHECK(played->state("soft.json")["selection"]["shape"] == "lock");
  CHECK(count("soft.json", "locked") > 20);
  CHECK(count("soft.json", "locked_in_part") > count("soft.json", "locked") / 2);
  CHECK(count("undone.json", "locked") == 0);
  CHECK(count("flat.json", "locked") >= count("soft.json", "locked"));
  CHECK(count("flat.json", "locked_in_part") == 0);
  CHECK(count("freed.json", "locked") < count("flat.json", "locked"));
  CHECK(count("freed.json", "locked") > 0);
  CHECK(played->state("freed.json")["errors"].empty());
}

}  // namespace palpate::view_lock_test
