#include <fmt/format.h>

#include "tests/apps/program.hpp"

namespace palpate::strokes_test {

TEST_CASE("bench strokes repeats a stroke by its number, and a gentle one on a ball is whole") {
  const ScratchFolder folder;
  const std::string model = (folder / "model.ply").string();
  works("make sphere -n 4000 -o " + model);
  const std::string bench = "bench strokes --brushes push --seed 5 --models " + model + " --json ";
  works(bench + (folder / "all.json").string() + " --strokes 6");
  const auto all = jsonOf(folder / "all.json")["strokes"];
  REQUIRE(all["strokes"].size() == 6);
  std::size_t broken = 0;
  for (const auto& stroke : all["strokes"]) {
    CAPTURE(stroke.dump());
    broken += !stroke["broken"].empty();
    CHECK(stroke["brush"] == "push");
    CHECK(stroke["place"] == "flat");
    CHECK(stroke["changed"] > 0);
    CHECK(stroke["region"] >= stroke["region_before"]);
    CHECK(stroke["deepest_mm"] > 0.5);
    const bool gentle = stroke["depth_mm"] == 2;
    if (gentle) CHECK(stroke["broken"].empty());
  }
  CHECK(all["broken"] == broken);
  const std::string saved = (folder / "saved").string();
  works(bench + (folder / "one.json").string() + " --only 3 --save-worst " + saved);
  const auto one = jsonOf(folder / "one.json")["strokes"]["strokes"];
  REQUIRE(one.size() == 1);
  for (const char* key : {"number", "deepest_mm", "region", "depth_mm", "turned"})
    CHECK(one[0][key] == all["strokes"][3][key]);
  CHECK(std::filesystem::exists(folder / "saved" / "0003_model_push_flat_after.ply"));
  CHECK(std::filesystem::exists(folder / "saved" / "0003_model_push_flat_path.csv"));
}

TEST_CASE("bench strokes drags the mouse over a picture, as deep as it presses, twice alike") {
  const ScratchFolder folder;
  const std::string model = (folder / "model.ply").string();
  works("make sphere -n 4000 -o " + model);
  const std::string bench =
      "bench strokes --hand mouse --brushes push --seed 5 --strokes 4 --models " + model + " --json ";
  works(bench + (folder / "one.json").string());
  works(bench + (folder / "two.json").string());
  const auto one = jsonOf(folder / "one.json")["strokes"]["strokes"];
  const auto two = jsonOf(folder / "two.json")["strokes"]["strokes"];
  REQUIRE(one.size() == 4);
  for (std::size_t k = 0; k < one.size(); ++k) {
    CAPTURE(one[k].dump());
    CHECK(one[k]["broken"].empty());
    CHECK(one[k]["depth_mm"] == 3);
    CHECK(one[k]["expected_mm"] == 2.5);
    CHECK(one[k]["deepest_mm"] > 2);
    CHECK(one[k]["deepest_mm"] < 2.9);
    for (const char* key : {"changed", "inserted", "deepest_mm", "drag_mm", "ticks"}) CHECK(one[k][key] == two[k][key]);
  }
}

TEST_CASE("bench strokes refuses a seed that is no number, and no models") {
  CHECK(palpate("bench strokes --models x.ply --seed cheese").code == 2);
  CHECK(palpate("bench strokes --strokes 1").code == 2);
}

}  // namespace palpate::strokes_test
