// What a person does in the panels, by clicks on what they show.
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_panels_test {

namespace {

void makeTwo(const std::filesystem::path& folder) {
  makeSphere(folder, 5000);
  works("--quiet make torus -n 1000 -o " + (folder / "torus.ply").string());
}

// Presses the brush into the middle of a window of 800 x 600.
constexpr const char* kStroke = R"(
0.10 mouse 400 300
0.20 key space down
0.25 button left down
1.45 button left up
1.50 key space up
1.55 ask
1.60 state %/dent.json
)";

}  // namespace

TEST_CASE("the curves pause, and go to CSV files, none over another") {
  if (!hasDisplay()) return;
  const auto played = play("%/sphere.ply --size 800x600", R"(
0.10 mouse 400 300
0.20 key space down
0.25 button left down
1.35 state %/pressed.json
1.45 button left up
1.45 key space up
1.45 click Pause
1.60 screenshot %/paused.png
2.10 screenshot %/later.png
2.15 click Go on
2.35 screenshot %/on.png
2.40 click Export CSV
2.45 state %/first.json
2.50 click Export CSV
2.55 quit
)",
                           "", makeTwo);
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  const auto& folder = played->folder.path();
  const auto picture = [&](const char* name) { return Picture(folder / name); };
  const Picture paused = picture("paused.png"), later = picture("later.png"), on = picture("on.png");
  // The curve of what ticks took, between its edges: no two stretches of it are the same.
  int pausedMoved = 0, moved = 0;
  for (const int x : {600, 660, 720}) {
    pausedMoved += differing(paused, later, x, 172, 14);
    moved += differing(paused, on, x, 172, 14);
  }
  CHECK(pausedMoved == 0);
  CHECK(moved > 0);

  const auto rows = readTrace(folder / "sphere-ticks-1.csv");
  const std::string message = played->state("first.json")["last_message"];
  CHECK_MESSAGE(message == fmt::format("{} ticks are in {}", rows.size(), (folder / "sphere-ticks-1.csv").string()),
                message);
  REQUIRE(rows.size() > 1000);
  double most_N = 0;
  std::size_t touching = 0, wrong = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && !(rows[i].t_s > rows[i - 1].t_s)) ++wrong;
    if (!rows[i].contact && rows[i].penetration_mm > 0) ++wrong;
    if (rows[i].contact) ++touching;
    most_N = std::max(most_N, glm::length(rows[i].force));
  }
  CHECK(wrong == 0);
  CHECK(touching > 100);
  CHECK(touching < rows.size());
  CHECK(most_N == near(played->state("first.json")["peak_force_N"].get<double>(), 1e-3));
  CHECK(readTrace(folder / "sphere-ticks-2.csv").size() > rows.size());
}

TEST_CASE("the model stands in the middle of what the panels leave free, in dark and in light") {
  if (!hasDisplay()) return;
  const auto played = play("%/sphere.ply", R"(
0.10 screenshot %/large.png
0.15 resize 600 400
0.20 key r
0.35 screenshot %/small.png
0.40 key tab
0.45 key r
0.60 screenshot %/bare.png
0.65 key tab
0.70 click Look
0.75 click dark
0.90 screenshot %/light.png
0.95 quit
)",
                           "", makeTwo);
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  // Columns that have something of the model, which alone is brown.
  const auto columnsOf = [&](const char* name) {
    const Picture picture(played->folder.path() / name);
    std::pair<int, int> columns{picture.width, 0};
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        if (const auto p = picture.at(x, y); p[0] > p[1] + 15 && p[1] > p[2] + 8)
          columns = {std::min(columns.first, x), std::max(columns.second, x)};
    return columns;
  };
  const auto checkMiddle = [&](const char* name, int expected) {
    CAPTURE(name);
    const auto [first, last] = columnsOf(name);
    CAPTURE(first);
    CAPTURE(last);
    CHECK(std::abs((first + last) / 2 - expected) < 20);  // its shadow side is hardly brown
    CHECK(last - first > 150);
  };
  checkMiddle("large.png", (276 + 1011) / 2);  // curves on the other side
  checkMiddle("small.png", (276 + 600) / 2);
  CHECK(columnsOf("small.png").first > 276);
  checkMiddle("bare.png", 300);
  // The boxes to tick stand out from the light panel: some line of it is darker than both of its neighbours.
  const Picture light(played->folder.path() / "light.png");
  int lines = 0;
  for (int x = 12; x < 30; ++x)
    for (int y = 20; y < 390; ++y)
      if (light.at(x, y)[0] + 20 < light.at(x, y - 1)[0] && light.at(x, y)[0] + 20 < light.at(x, y + 1)[0]) ++lines;
  CHECK(lines > 40);
}

TEST_CASE("another model is not opened over changes before the person has said what becomes of them") {
  if (!hasDisplay()) return;
  const auto played = play("%/sphere.ply --size 800x600 --edit push", std::string(kStroke) + R"(
1.60 drop %/torus.ply
1.65 state %/asked.json
1.70 key ctrl+z
1.80 click Cancel
1.85 state %/cancelled.json
1.90 drop %/torus.ply
1.95 click Do not save
2.00 state %/discarded.json
2.05 quit
31.9 state %/after.json
)",
                           "", [](const auto& folder) {
                             makeTwo(folder);
                             std::filesystem::copy_file(folder / "sphere.ply", folder / "kept.ply");
                           });
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  const auto dent = played->state("dent.json"), asked = played->state("asked.json"),
             cancelled = played->state("cancelled.json"), discarded = played->state("discarded.json");
  REQUIRE(dent["changed"] == true);
  CHECK(dent["asks_about_changes"] == false);
  CHECK(asked["asks_about_changes"] == true);
  CHECK(asked["model"] == dent["model"]);
  CHECK(cancelled["asks_about_changes"] == false);
  CHECK(cancelled["model"] == dent["model"]);
  CHECK(cancelled["changed"] == true);
  CHECK(cancelled["edits"] == dent["edits"]);  // keys have nothing to say while it is asked
  CHECK(std::string(discarded["model"]).ends_with("torus.ply"));
  CHECK(discarded["asks_about_changes"] == false);
  const auto& folder = played->folder.path();
  CHECK(contentOf(folder / "sphere.ply") == contentOf(folder / "kept.ply"));
  CHECK_FALSE(std::filesystem::exists(folder / "after.json"));  // the torus has no changes: nothing is asked
}

TEST_CASE("changes are saved first where the person says so, and the window closes only then") {
  if (!hasDisplay()) return;
  const auto played = play("%/sphere.ply --size 800x600 --edit push", std::string(kStroke) + R"(
1.60 drop %/torus.ply
1.65 click Save
1.85 state %/torus.json
1.90 drop %/sphere.ply
1.95 state %/again.json
2.00 mouse 400 300
2.10 key space down
2.15 button left down
3.35 button left up
3.40 key space up
3.45 quit
3.50 state %/asked.json
3.55 key escape
3.60 state %/stays.json
3.65 key q
3.70 click Save
33.9 state %/after.json
)",
                           "", makeTwo);
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  const auto dent = played->state("dent.json"), again = played->state("again.json"),
             stays = played->state("stays.json");
  CHECK(std::string(played->state("torus.json")["model"]).ends_with("torus.ply"));
  CHECK(again["model"] == dent["model"]);
  CHECK(again["points"] == dent["points"]);
  CHECK(played->state("asked.json")["asks_about_changes"] == true);
  CHECK(stays["asks_about_changes"] == false);
  CHECK(stays["changed"] == true);
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "after.json"));
  // What was there at the end is in the file.
  const Outcome info = palpate("info --json - --quiet " + (played->folder.path() / "sphere.ply").string());
  CHECK(says(info.text, fmt::format("\"points\": {}", stays["points"].get<int>())));
}

TEST_CASE("what cannot be saved is not left behind") {
  if (!hasDisplay()) return;
  // No file can be written under a longer name, as is done before the model's own name is given to it.
  const std::string name = std::string(248, 's') + ".ply";
  const auto played = play("%/" + name + " --size 800x600 --edit push", std::string(kStroke) + R"(
1.60 quit
1.65 click Save
1.85 state %/failed.json
1.90 quit
1.95 click Do not save
31.9 state %/after.json
)",
                           "", [&](const auto& folder) {
                             makeSphere(folder, 2000);
                             std::filesystem::rename(folder / "sphere.ply", folder / name);
                           });
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  const auto failed = played->state("failed.json");
  CHECK(failed["changed"] == true);
  CHECK(failed["asks_about_changes"] == false);
  CHECK(says(std::string(failed["last_message"]), "cannot be written"));
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "after.json"));
}

TEST_CASE("the panels turn the surface, save under another name, record and play") {
  if (!hasDisplay()) return;
  const auto played = play("%/sphere.ply --size 800x600 --edit push", R"(
0.10 click Feel
0.15 click surface
0.20 click sharp
0.25 state %/sharp.json
0.30 click Feel
0.35 click Look
0.35 click Look
0.40 click Save and record
0.50 click session.log
0.55 text take.log
0.60 click Record
0.65 mouse 400 300
0.75 key space down
0.80 button left down
1.80 button left up
1.85 key space up
1.90 click Stop
1.95 state %/recorded.json
2.00 click other.ply
2.05 text saved.ply
2.10 click Save as
2.30 state %/saved.json
2.35 click Save as
2.55 state %/twice.json
2.60 click Record
2.65 state %/again.json
2.70 click Undo
2.75 click Play
5.05 state %/replayed.json
5.10 click Replace
5.15 state %/replaced.json
5.20 click Models
5.25 click file.ply
5.30 text torus.ply
5.35 key enter
5.40 state %/torus.json
5.45 quit
)",
                           "", makeTwo);
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  const auto& folder = played->folder.path();
  const auto recorded = played->state("recorded.json"), saved = played->state("saved.json");
  CHECK(played->state("sharp.json")["surface"] == "sharp");
  CHECK(recorded["edits"] > 0);
  CHECK(saved["changed"] == false);
  works("--quiet info " + (folder / "saved.ply").string());
  CHECK(says(std::string(played->state("twice.json")["last_message"]),
             "'Save as' cannot be clicked"));  // it says Replace now
  CHECK(contentOf(folder / "take.log").size() > 1000);
  CHECK(says(contentOf(folder / "take.log"), "sharp"));
  CHECK(played->state("replayed.json")["edits"] > recorded["edits"]);
  CHECK(played->state("replaced.json")["changed"] == false);
  CHECK(std::string(played->state("torus.json")["model"]).ends_with("torus.ply"));
  CHECK(says(palpate("replay --tolerance 1e-9 " + (folder / "take.log").string()).text, "give the recorded points"));
}

TEST_CASE("a model that is dropped while another one is loaded comes instead of it") {
  if (!hasDisplay()) return;
  const auto played = play("--size 320x240", R"(
0.10 impatient
0.15 drop %/large.ply
0.20 drop %/torus.ply
0.20 patient
0.25 state %/torus.json
0.30 quit
)",
                           "", [](const auto& folder) {
                             makeTwo(folder);
                             works("--quiet make sphere -n 300000 -o " + (folder / "large.ply").string());
                           });
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  CHECK(std::string(played->state("torus.json")["model"]).ends_with("torus.ply"));
  CHECK(contentOf(played->folder.path() / "state" / "palpate" / "recent").find("large.ply") == std::string::npos);
}

TEST_CASE("what could not be opened is not offered again, and Tab takes the panels away") {
  if (!hasDisplay()) return;
  const auto played = play("--size 480x360", R"(
0.10 drop %/broken.ply
0.15 state %/broken.json
0.20 click broken.ply
0.25 state %/again.json
0.30 drop %/torus.ply
0.35 key tab
0.40 click Models
0.45 state %/away.json
0.50 key tab
0.55 click Models
0.60 click torus.ply
0.65 state %/back.json
0.70 quit
)",
                           "", [](const auto& folder) {
                             makeTwo(folder);
                             std::ofstream(folder / "broken.ply") << "no cloud";
                           });
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  const auto message = [&](const char* name) { return std::string(played->state(name)["last_message"]); };
  CHECK(says(message("broken.json"), "not a PLY file"));
  CHECK(says(message("again.json"), "'broken.ply' cannot be clicked"));
  CHECK(says(message("away.json"), "'Models' cannot be clicked"));
  CHECK(message("back.json") == message("away.json"));  // nothing was clicked in vain
}

}  // namespace palpate::view_panels_test
