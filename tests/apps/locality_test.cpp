#include <fmt/format.h>

#include "tests/apps/program.hpp"

namespace palpate::locality_test {

TEST_CASE("bench locality plays every brush and gesture on every cloud, and fails if a guarantee is broken") {
  const ScratchFolder folder;
  const std::string model = (folder / "model.ply").string();
  works("make sphere -n 3000 -o " + model);
  const Outcome outcome = palpate("bench locality --backend cpu --models " + model +
                                  " --clouds even,plate --sizes 3000 --brushes paint,push --hold 0.05 --json " +
                                  (folder / "l.json").string());
  const auto locality = jsonOf(folder / "l.json")["locality"];
  REQUIRE(locality["strokes"].size() == 3 * 2 * 2);
  std::size_t broken = 0, strictly = 0;
  for (const auto& stroke : locality["strokes"]) {
    CAPTURE(stroke.dump());
    broken += !stroke["broken"].empty();
    strictly += !stroke["strictly_broken"].empty();
    // A promise broken with tolerance is also broken without.
    CHECK(stroke["strictly_broken"].size() >= stroke["broken"].size());
    const bool crowds = stroke["crowded_share"] > 0, turns = stroke["normals"]["turned"] > 0;
    if (crowds || turns) CHECK(!stroke["strictly_broken"].empty());
    CHECK(stroke["acting_ticks"] > 20);
    CHECK(stroke["look_before"]["ticks"] > 90);
    CHECK(stroke["look_after"]["ticks"] > 90);
    CHECK(stroke["normals"]["p95_deg"] < 30);
    const bool paints = stroke["brush"] == "paint";
    CHECK((stroke["painted"] > 0) == paints);
    CHECK((stroke["moved"] > 0) == !paints);
    CHECK(stroke["farthest_moved_R"] <= 0.13);
    if (!paints) continue;
    CHECK(stroke["inserted"] == 0);
    CHECK(stroke["broken"].empty());
  }
  CHECK(locality["broken"] == broken);
  CHECK(locality["strictly_broken"] == strictly);
  CHECK(outcome.text.find(fmt::format("{} of 12 strokes meet all requirements within the judge's tolerance, {} without",
                                      12 - broken, 12 - strictly)) != std::string::npos);
  CHECK(outcome.code == (broken > 0 ? 1 : 0));
  CHECK((outcome.text.find("changed what an edit may not") != std::string::npos) == (broken > 0));
  for (const char* heading : {"far moved", "turned", "broken"}) CHECK(outcome.text.find(heading) != std::string::npos);
}

TEST_CASE("bench locality refuses unknown names and an empty selection") {
  CHECK(palpate("bench locality --backend cpu --clouds cheese").code == 2);
  CHECK(palpate("bench locality --backend cpu --brushes comb").code == 2);
  CHECK(palpate("bench locality --backend cpu --clouds none").code == 2);
  CHECK(palpate("bench locality --backend cuda").code == 2);
  CHECK(palpate("bench locality build --backend cpu").code == 2);
}

}  // namespace palpate::locality_test
