// ctest: alone
// palpate bench coexist: touch while pictures are drawn. Checks counts, not speed.
#include <fmt/format.h>

#include <cmath>

#include "tests/apps/program.hpp"
#include "tests/labels.hpp"

namespace palpate::coexist_test {

namespace {

// Ticks are slow enough for a software driver on busy cores.
double seconds() { return byTier(0.6, 2.0); }
int points() { return byTier(3000, 5000); }
std::string smallBench() {
  return fmt::format("bench coexist --sizes {} --size {} --touched 50 --rate 50 --duration {} ", points(),
                     byTier("96x72", "160x120"), seconds());
}

void checkRow(const Result& row) {
  const std::string situation = row["situation"];
  CAPTURE(row.dump());
  CHECK(row["points"] == points());
  CHECK(row["ticks"].get<int>() + row["missed_ticks"].get<int>() == std::lround(50 * seconds()));
  CHECK(row["step_us"]["n"] == row["ticks"]);
  CHECK(row["step_us"]["p50"] > 0);
  CHECK(row["step_us"]["max"] >= row["step_us"]["p999"].get<double>());
  CHECK(row["contact_ticks"] > 0);
  const bool sculpts = situation.ends_with("sculpting");
  CHECK((row["edits"] > 0) == sculpts);
  CHECK((row["states_made"] > 0) == sculpts);
  CHECK(row.contains("sight") == situation.starts_with("drawn"));
  if (!row.contains("sight")) return;
  const auto sight = row["sight"];
  CHECK(sight["pictures"] > 0);
  CHECK(sight["fps"] > 0);
  CHECK(sight["picture_ms"]["n"] == sight["pictures"]);
  CHECK(sight["states_seen"] == row["states_made"]);
  CHECK((sight["changed_pixels"] > 0) == sculpts);
}

}  // namespace

TEST_CASE("bench coexist counts ticks and pictures in every situation, and the pictures contain the edits" *
          kMoreInFull) {
  const ScratchFolder folder;
  const std::string json = (folder / "c.json").string();
  const Outcome outcome =
      palpate(smallBench() + byTier("--queues separate --json ", "--queues separate,same --json ") + json);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const auto result = jsonOf(json)["coexist"];
  CHECK(result["size"] == byTier<std::vector<int>>({96, 72}, {160, 120}));
  CHECK(result["samples"] == 1);
  REQUIRE(result["rows"].size() == byTier<std::size_t>(1, 2) * 4);
  for (std::size_t i = 0; i < result["rows"].size(); ++i) {
    CHECK(result["rows"][i]["queues"] == (i < 4 ? "separate" : "same"));
    checkRow(result["rows"][i]);
  }
  for (const char* title : {"drawn-sculpting", "missed", "p99.9", "fps"})
    CHECK(outcome.text.find(title) != std::string::npos);
}

TEST_CASE("bench coexist draws what another device touches: edits arrive through the host" * kMoreInFull) {
  const ScratchFolder folder;
  const std::string json = (folder / "c.json").string();
  for (const std::string elsewhere : {"--queues separate --sight-gpu 0 ", "--backend cpu "}) {
    if (!inFullTier() && elsewhere != "--backend cpu ") continue;
    CAPTURE(elsewhere);
    works(smallBench() + "--situations drawn-sculpting " + elsewhere + "--json " + json);
    const auto rows = jsonOf(json)["coexist"]["rows"];
    REQUIRE(rows.size() == 1);
    checkRow(rows[0]);
  }
}

TEST_CASE("bench coexist draws and touches without validation messages, on one GPU and on two" * kMoreInFull) {
  const std::string arguments = std::string("bench coexist ") + byTier("--validate=core", "--validate") +
                                " --sizes 2000 --size 64x48 --touched 50 --rate 20 --duration 1 --situations "
                                "drawn-sculpting --queues no-priority";
  if (inFullTier()) works(arguments);  // otherwise covered by the window's own case
  works(arguments + " --sight-gpu 0");
}

TEST_CASE("bench coexist refuses what it cannot measure") {
  CHECK(palpate("bench coexist --sizes 2000 --backend vulkan,cpu").code == 2);
  CHECK(palpate("bench coexist --sizes 2000 --queues two").code == 2);
  CHECK(palpate("bench coexist --sizes 2000 --situations asleep").code == 2);
  CHECK(palpate("bench coexist --sizes 2000 --touched 10 100").code == 2);
  CHECK(palpate("bench coexist --sizes 2000 --size 320").code == 2);
  CHECK(palpate("bench coexist edit --sizes 2000").code == 2);
  CHECK(palpate("bench coexist --sizes 2000 --plot c.png").code == 2);
  checkEnds(1, "bench coexist --sizes 2000 --duration 0.1 --situations drawn --sight-gpu nowhere", {"nowhere"});
}

}  // namespace palpate::coexist_test
