// Operating the panels by clicks on their controls.
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_panels_test {

namespace {

void makeTwo(const std::filesystem::path& folder) {
  makeSphere(folder, 3000);
  works("--quiet make torus -n 1000 -o " + (folder / "torus.ply").string());
}

// Presses the brush into the middle of the area that the panel leaves free in a window of 480 x 360.
constexpr const char* kStroke = R"(
0.1 mouse 132 180
0.4 key space down
0.5 button left down
1.3 button left up
1.4 key space up
1.6 ask
1.7 state %/dent.json
)";

}  // namespace

TEST_CASE("the curves pause, and are exported to CSV files, none of which overwrites another") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 800x400 --rate 500", makeTwo, R"(
0.1 key c
0.1 mouse 167 200
0.4 key space down
0.5 button left down
1.6 state %/pressed.json
1.7 button left up
1.7 key space up
1.7 click Pause
2.0 screenshot %/paused.png
2.9 screenshot %/later.png
3.0 click Continue
3.4 screenshot %/on.png
3.5 click Export CSV
3.7 state %/first.json
3.8 click Export CSV
4.0 quit
)");
  const auto& folder = played->folder.path();
  const auto picture = [&](const char* name) { return Picture(folder / name); };
  const Picture paused = picture("paused.png"), later = picture("later.png"), on = picture("on.png");
  // The curve of tick durations, between its edges: no two sections of it are equal.
  int pausedMoved = 0, moved = 0;
  for (const int x : {340, 420, 500}) {
    pausedMoved += differing(paused, later, x, 172, 14);
    moved += differing(paused, on, x, 172, 14);
  }
  CHECK(pausedMoved == 0);
  CHECK(moved > 0);

  const auto rows = readTrace(folder / "sphere-ticks-1.csv");
  const std::string message = played->state("first.json")["last_message"];
  CHECK_MESSAGE(message == fmt::format("{} ticks are in {}", rows.size(), (folder / "sphere-ticks-1.csv").string()),
                message);
  REQUIRE(rows.size() > 500);
  double most_N = 0;
  std::size_t touching = 0, wrong = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && !(rows[i].t_s > rows[i - 1].t_s)) ++wrong;
    if (!rows[i].contact && rows[i].penetration_mm > 0) ++wrong;
    if (rows[i].contact) ++touching;
    most_N = std::max(most_N, glm::length(rows[i].force));
  }
  CHECK(wrong == 0);
  CHECK(touching > 50);
  CHECK(touching < rows.size());
  CHECK(most_N == near(played->state("first.json")["peak_force_N"].get<double>(), 1e-3));
  CHECK(readTrace(folder / "sphere-ticks-2.csv").size() > rows.size());
}

TEST_CASE("the model is centred in the area that the panels leave free, in dark and in light") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply", makeTwo, R"(
0.1 key c
0.4 screenshot %/large.png
0.5 resize 600 400
1.2 screenshot %/small.png
1.3 key tab
1.7 screenshot %/bare.png
1.8 key tab
1.9 click Look
2.0 click theme
2.2 click light
2.4 screenshot %/light.png
2.5 quit
)");
  // Columns that contain a part of the model, the only brown object.
  const auto columnsOf = [&](const char* name) {
    const Picture picture(played->folder.path() / name);
    std::pair<int, int> columns{picture.width, 0};
    for (int y = 0; y < picture.height; ++y)
      for (int x = 42; x < picture.width; ++x)  // beside the tools
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
  checkMiddle("large.png", (42 + 763) / 2);  // the curves are on the other side
  checkMiddle("small.png", (42 + 352) / 2);
  CHECK(columnsOf("small.png").second < 352);
  checkMiddle("bare.png", 300);
  // Check boxes stand out from the light panel: some line of it is darker than both of its neighbours.
  const Picture light(played->folder.path() / "light.png");
  int lines = 0;
  for (int x = 366; x < 388; ++x)
    for (int y = 20; y < 390; ++y)
      if (light.at(x, y)[0] + 20 < light.at(x, y - 1)[0] && light.at(x, y)[0] + 20 < light.at(x, y + 1)[0]) ++lines;
  CHECK(lines > 40);
}

TEST_CASE("another model is opened only after the user has decided what happens to unsaved changes") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/sphere.ply --size 480x360 --rate 250 --edit push",
      [](const auto& folder) {
        makeTwo(folder);
        std::filesystem::copy_file(folder / "sphere.ply", folder / "kept.ply");
      },
      std::string(kStroke) + R"(
1.8 drop %/torus.ply
2.0 state %/asked.json
2.1 key ctrl+z
2.2 click Cancel
2.5 state %/cancelled.json
2.6 drop %/torus.ply
2.8 click Do not save
3.1 state %/discarded.json
3.2 quit
31.9 state %/after.json
)");
  const auto dent = played->state("dent.json"), asked = played->state("asked.json"),
             cancelled = played->state("cancelled.json"), discarded = played->state("discarded.json");
  REQUIRE(dent["changed"] == true);
  CHECK(dent["asks_about_changes"] == false);
  CHECK(asked["asks_about_changes"] == true);
  CHECK(asked["question"] ==
        "Before opening torus.ply: sphere.ply has changes that are not saved. Without saving they are lost.");
  CHECK(asked["model"] == dent["model"]);
  CHECK(cancelled["asks_about_changes"] == false);
  CHECK(cancelled["model"] == dent["model"]);
  CHECK(cancelled["changed"] == true);
  CHECK(cancelled["edits"] == dent["edits"]);  // keys have no effect while the question is open
  CHECK(std::string(discarded["model"]).ends_with("torus.ply"));
  CHECK(discarded["asks_about_changes"] == false);
  const auto& folder = played->folder.path();
  CHECK(contentOf(folder / "sphere.ply") == contentOf(folder / "kept.ply"));
  CHECK_FALSE(std::filesystem::exists(folder / "after.json"));  // the torus has no changes, so no question appears
}

TEST_CASE("changes are saved first if the user chooses so, and the window closes only after that") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250 --edit push", makeTwo, std::string(kStroke) + R"(
1.8 drop %/torus.ply
2.0 click Save
2.3 state %/torus.json
2.4 drop %/sphere.ply
2.6 state %/again.json
2.7 mouse 132 180
3.0 key space down
3.1 button left down
4.1 button left up
4.2 key space up
4.4 quit
4.6 state %/asked.json
4.7 key escape
4.9 state %/stays.json
5.0 key q
5.2 click Save
33.9 state %/after.json
)");
  const auto dent = played->state("dent.json"), again = played->state("again.json"),
             stays = played->state("stays.json");
  CHECK(std::string(played->state("torus.json")["model"]).ends_with("torus.ply"));
  CHECK(again["model"] == dent["model"]);
  CHECK(again["points"] == dent["points"]);
  CHECK(played->state("asked.json")["asks_about_changes"] == true);
  CHECK(stays["asks_about_changes"] == false);
  CHECK(stays["changed"] == true);
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "after.json"));
  // The file contains the points as they were at the end.
  const Outcome info = palpate("info --json - --quiet " + (played->folder.path() / "sphere.ply").string());
  CHECK(says(info.text, fmt::format("\"points\": {}", stays["points"].get<int>())));
}

TEST_CASE("a failed save keeps the changes and the window open") {
  if (!hasDisplay()) return;
  // The longest path that can be read: saving fails, since it first writes a temporary file with a longer name.
  constexpr std::size_t kLongestPath = 4095, kLongestName = 200;
  const auto played = playWell(
      "%/model.ply --size 480x360 --rate 250 --edit push",
      [&](const auto& folder) {
        makeSphere(folder, 2000);
        std::filesystem::path at = folder;
        const std::string name = "/sphere.ply";
        while (at.string().size() + name.size() < kLongestPath)
          at /= std::string(std::min(kLongestName, kLongestPath - name.size() - at.string().size() - 1), 'd');
        std::filesystem::create_directories(at);
        std::filesystem::rename(folder / "sphere.ply", at.string() + name);
        std::filesystem::create_symlink(at.string() + name, folder / "model.ply");
      },
      std::string(kStroke) + R"(
1.8 quit
2.0 click Save
2.4 state %/failed.json
2.5 quit
2.7 click Do not save
31.9 state %/after.json
)");
  const auto failed = played->state("failed.json");
  CHECK(failed["changed"] == true);
  CHECK(failed["asks_about_changes"] == false);
  CHECK(says(std::string(failed["last_message"]), "cannot be written"));
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "after.json"));
}

TEST_CASE("a message that is repeated is shown once") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --backend cpu", makeTwo,
                               "0.2 key ctrl+s\n0.5 key ctrl+s\n0.8 state %/state.json\n0.9 quit\n");
  const auto messages = played->state("state.json")["messages"];
  std::size_t shown = 0;
  for (const auto& message : messages) shown += says(message.get<std::string>(), "there is nothing to save");
  CHECK(shown == 1);
}

TEST_CASE("settings for experts are shown under more, and not before it is opened") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x600 --backend cpu --edit push", makeTwo, R"(
0.2 click size
0.4 state %/usual.json
0.5 click speed
1.0 state %/closed.json
1.1 click more
1.5 click speed
2.0 click resistance
2.5 state %/open.json
2.6 quit
)");
  const auto misses = [&](const char* file) { return played->state(file)["errors"].size(); };
  CHECK(misses("usual.json") == 0);
  CHECK(misses("closed.json") == 1);
  CHECK(misses("open.json") == 1);
}

TEST_CASE("the panels choose the surface, save under another name, record and replay") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x600 --rate 250 --edit push", makeTwo, R"(
0.1 click Feel
0.3 click surface
0.5 click sharp
0.7 state %/sharp.json
0.8 click Feel
0.9 click Look
0.9 click Look
1.0 click Save and record
1.1 click session.log
1.2 text take.log
1.3 click Record
1.5 mouse 132 300
1.8 key space down
1.9 button left down
2.5 button left up
2.6 key space up
2.7 click Stop
2.9 state %/recorded.json
3.0 click other.ply
3.1 text saved.ply
3.2 click Save as
3.7 state %/saved.json
3.8 click Save as
4.0 state %/twice.json
4.1 click Record
4.3 state %/again.json
4.4 click Undo
4.6 click Play
7.0 state %/replayed.json
7.1 click Replace
7.6 state %/replaced.json
7.7 click Models
7.8 click file.ply
7.9 text torus.ply
8.0 key enter
8.2 state %/torus.json
8.3 quit
)");
  const auto& folder = played->folder.path();
  const auto recorded = played->state("recorded.json"), saved = played->state("saved.json");
  CHECK(played->state("sharp.json")["surface"] == "sharp");
  CHECK(recorded["edits"] > 0);
  CHECK(saved["changed"] == false);
  works("--quiet info " + (folder / "saved.ply").string());
  CHECK(says(std::string(played->state("twice.json")["last_message"]),
             "'Save as' cannot be clicked"));  // the button's label is now Replace
  CHECK(contentOf(folder / "take.log").size() > 1000);
  CHECK(says(contentOf(folder / "take.log"), "sharp"));
  CHECK(played->state("replayed.json")["edits"] > recorded["edits"]);
  CHECK(played->state("replaced.json")["changed"] == false);
  CHECK(std::string(played->state("torus.json")["model"]).ends_with("torus.ply"));
  CHECK(says(palpate("replay --tolerance 1e-9 " + (folder / "take.log").string()).text, "give the recorded points"));
}

TEST_CASE("a model dropped while another one loads is loaded instead of it") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "--size 320x240",
      [](const auto& folder) {
        makeTwo(folder);
        works("--quiet make sphere -n 300000 -o " + (folder / "large.ply").string());
      },
      R"(
0.1 impatient
0.2 drop %/large.ply
0.3 drop %/torus.ply
0.3 patient
0.4 state %/torus.json
0.5 quit
)");
  CHECK(std::string(played->state("torus.json")["model"]).ends_with("torus.ply"));
  CHECK(contentOf(played->folder.path() / "state" / "palpate" / "recent").find("large.ply") == std::string::npos);
}

TEST_CASE("a file that could not be opened is not listed among the models, and Tab hides the panels") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "--size 480x360",
      [](const auto& folder) {
        makeTwo(folder);
        std::ofstream(folder / "broken.ply") << "no cloud";
      },
      R"(
0.1 drop %/broken.ply
0.2 state %/broken.json
0.3 click broken.ply
0.4 state %/again.json
0.5 drop %/torus.ply
0.6 key tab
0.7 click Models
0.8 state %/away.json
0.9 key tab
1.0 click Models
1.1 click torus.ply
1.2 state %/back.json
1.3 quit
)");
  const auto message = [&](const char* name) { return std::string(played->state(name)["last_message"]); };
  CHECK(says(message("broken.json"), "broken.ply: is not a PLY file"));
  CHECK(says(message("again.json"), "'broken.ply' cannot be clicked"));
  CHECK(says(message("away.json"), "'Models' cannot be clicked"));
  CHECK(message("back.json") == message("away.json"));  // no further message: both clicks hit a control
}

}  // namespace palpate::view_panels_test
