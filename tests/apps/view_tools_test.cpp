// The tools at the left, the status line, themes, the size of text, the start screen and the help that searches.
#include <set>

#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_tools_test {

namespace {

// Columns that contain a part of the made models, the only brown objects below the icons of the start screen.
std::pair<int, int> brownColumns(const Picture& picture) {
  std::pair<int, int> columns{picture.width, -1};
  for (int y = 320; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (const auto p = picture.at(x, y); p[0] > p[1] + 15 && p[1] > p[2] + 8)
        columns = {std::min(columns.first, x), std::max(columns.second, x)};
  return columns;
}

}  // namespace

TEST_CASE("the icons choose what their keys choose, in any size of window and of text") {
  if (!hasDisplay()) return;
  for (const std::string size :
       {"--size 900x600", "--size 480x360", "--size 1280x720 --text-size 200", "--size 900x600 --text-size 200"}) {
    CAPTURE(size);
    const auto played = playWell("%/sphere.ply --backend cpu " + size, sphereOf(1000), R"(
0.1 click carve
0.2 state %/carve.json
0.3 click Select
0.4 click lasso
0.5 state %/lasso.json
0.6 click move
0.7 state %/move.json
0.8 click Only look
0.9 click Without perspective
1.0 state %/look.json
1.1 click Ruler
1.2 state %/ruler.json
1.3 click Sculpt
1.4 click feel
1.5 state %/feel.json
1.6 quit
)");
    const auto state = [&](const char* name) { return played->state(name); };
    CHECK(state("feel.json")["errors"].empty());
    CHECK(state("carve.json")["tool"] == "carve");
    CHECK(state("lasso.json")["mouse"] == "selecting");
    CHECK(state("lasso.json")["selection"]["shape"] == "lasso");
    CHECK(state("move.json")["selection"]["shape"] == "move");
    CHECK(state("look.json")["mouse"] == "looking");
    CHECK_FALSE(state("look.json")["camera"]["ortho"].is_null());
    CHECK(state("ruler.json")["measuring"] == true);
    CHECK(state("feel.json")["mouse"] == "sculpting");
    CHECK(state("feel.json")["tool"] == "feel");
  }
}

TEST_CASE("each tool of the column has a key of its own, which chooses it, and measuring lights the ruler alone") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --backend cpu --size 900x600", sphereOf(1000), R"(
0.1 state %/sculpt.json
0.2 key d
0.4 state %/measure.json
0.5 key 3
0.7 state %/carve.json
0.8 key s
1.0 state %/select.json
1.1 key shift+w
1.3 state %/ball.json
1.4 key shift+d
1.6 state %/ruler.json
1.7 key shift+s
1.9 state %/back.json
2.0 key v
2.2 state %/look.json
2.3 quit
)");
  const auto on = [&](const char* name) {
    std::vector<std::string> lit;
    for (const auto& tool : played->state(name)["tools"])
      if (tool["on"]) lit.push_back(tool["name"]);
    return lit;
  };
  using Names = std::vector<std::string>;
  CHECK(on("sculpt.json") == Names{"Sculpt", "feel"});
  CHECK(on("measure.json") == Names{"Ruler"});
  CHECK(on("carve.json") == Names{"Sculpt", "carve"});
  CHECK(on("select.json") == Names{"Select", "rectangle"});
  CHECK(on("ball.json") == Names{"Select", "ball"});
  CHECK(on("ruler.json") == Names{"Ruler"});
  CHECK(on("back.json") == Names{"Sculpt", "carve"});
  for (const char* const name : {"sculpt.json", "select.json", "look.json"}) {
    CAPTURE(name);
    std::set<std::string> keys;
    const Result state = played->state(name);
    for (const auto& tool : state["tools"]) {
      CHECK(tool["key"] != "");
      keys.insert(tool["key"]);
    }
    CHECK(keys.size() == state["tools"].size());
  }
}

TEST_CASE("undo names what it has undone, and what is undone next") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --backend cpu --size 900x600", sphereOf(1000), R"(
0.2 key s
0.3 key ctrl+a
0.6 value classification 2
0.8 key ctrl+z
1.0 state %/field.json
1.1 key ctrl+z
1.4 state %/selection.json
1.5 key ctrl+shift+z
1.7 state %/redone.json
1.8 quit
)");
  const auto said = [&](const char* name) { return std::string(played->state(name)["last_message"]); };
  CHECK(said("field.json") == "New field classification undone. Next, Ctrl+Z undoes: selection, 1000 points");
  CHECK(said("selection.json") == "Selection undone: 1000 points. Nothing more can be undone");
  CHECK(said("redone.json") == "Selection redone: 1000 points. Next, Ctrl+Z undoes: selection, 1000 points");
  CHECK(played->state("selection.json")["messages"].dump().find("classification undone") == std::string::npos);
}

TEST_CASE("the status line has the position under the cursor and the counts of points") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 900x600 --backend cpu", sphereOf(1000), R"(
0.1 mouse 60 560
0.6 state %/beside.json
0.7 mouse 350 290
1.2 state %/on.json
1.3 key s
1.4 key ctrl+a
1.6 state %/all.json
1.7 quit
)");
  const auto line = [&](const char* name) { return std::string(played->state(name)["status_line"]); };
  CHECK_MESSAGE(line("beside.json").starts_with("1000 points"), line("beside.json"));
  double x = 0, y = 0, z = 0;
  CHECK_MESSAGE(std::sscanf(line("on.json").c_str(), "x %lf y %lf z %lf", &x, &y, &z) == 3, line("on.json"));
  CHECK(std::sqrt(x * x + y * y + z * z) == near(50, 0.03));  // the sphere's radius
  CHECK_MESSAGE(says(line("all.json"), "1000 selected"), line("all.json"));
}

TEST_CASE("theme, size of text and dismissed first steps are kept for the next window") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/sphere.ply --size 900x600 --backend cpu",
      [](const auto& folder) {
        makeSphere(folder, 1000);
        std::filesystem::create_directories(folder / "state" / "palpate");
        std::ofstream(folder / "state" / "palpate" / "window") << "first_steps yes\n";
      },
      R"(
0.2 state %/first.json
0.3 click Understood
0.4 key f6
0.5 click theme
0.7 click light
0.8 key ctrl++
0.9 key ctrl++
1.2 state %/changed.json
1.3 screenshot %/light.png
1.4 quit
)");
  const auto first = played->state("first.json"), changed = played->state("changed.json");
  CHECK(first["first_steps"] == true);
  CHECK(first["theme"] == "dark");
  CHECK(changed["first_steps"] == false);
  CHECK(changed["text_size"] == 125);
  const auto& folder = played->folder.path();
  CHECK(Picture(folder / "light.png").at(2, 590)[0] > 220);
  std::ofstream(folder / "again.txt") << inFolder("0.2 state %/again.json\n0.3 quit\n", folder);
  CHECK(run(inFolder("cd % && XDG_STATE_HOME=%/state xvfb-run -a ", folder) + program() +
            inFolder(" --quiet view %/sphere.ply --script %/again.txt", folder))
            .code == 0);
  const auto again = played->state("again.json");
  CHECK(again["theme"] == "light");
  CHECK(again["text_size"] == 125);
  CHECK(again["first_steps"] == false);
}

TEST_CASE("the start screen opens what can be tried, and shows the last files as pictures") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "--size 900x600 --backend cpu",
      [](const auto& folder) {
        std::filesystem::create_directories(folder / "state" / "palpate");
        std::ofstream(folder / "state" / "palpate" / "recent") << folder.string() << "/lost.ply\n";
      },
      R"(
0.1 screenshot %/start.png
0.2 click lost.ply
0.3 state %/lost.json
0.4 click Carve a sculpture
0.6 state %/carve.json
1.2 quit
)");
  const auto& folder = played->folder.path();
  CHECK(says(std::string(played->state("lost.json")["last_message"]), "'lost.ply' cannot be clicked"));
  CHECK(says(std::string(played->state("carve.json")["model"]), "sculpture.ply"));
  CHECK(played->state("carve.json")["tool"] == "carve");
  CHECK(brownColumns(Picture(folder / "start.png")).second == -1);
  const auto pictures = folder / "state" / "palpate" / "pictures";
  REQUIRE(std::distance(std::filesystem::directory_iterator(pictures), {}) == 1);
  CHECK(std::filesystem::file_size(std::filesystem::directory_iterator(pictures)->path()) < 40'000);
  std::ofstream(folder / "again.txt") << inFolder(
      "0.2 screenshot %/again.png\n0.3 click sculpture.ply\n0.5 state "
      "%/again.json\n0.6 quit\n",
      folder);
  CHECK(run(inFolder("cd % && XDG_STATE_HOME=%/state xvfb-run -a -s '-screen 0 1600x1000x24' ", folder) + program() +
            inFolder(" --quiet view --size 900x600 --backend cpu --script %/again.txt", folder))
            .code == 0);
  const auto [left, right] = brownColumns(Picture(folder / "again.png"));
  CHECK(right - left > 40);
  CHECK(right - left < 120);  // within the small picture
  CHECK(played->state("again.json")["model"] == played->state("carve.json")["model"]);
}

TEST_CASE("the start screen shows ten last files as pictures, and opens the last of them") {
  if (!hasDisplay()) return;
  constexpr int kFiles = 10;
  std::string script;
  for (int k = 1; k < kFiles; ++k) script += fmt::format("{:.1f} drop %/{}.xyz\n", 0.4 * k, k);
  const auto played = playWell(
      "%/0.xyz --size 900x600 --backend cpu --up y",
      [](const std::filesystem::path& folder) {
        std::ofstream sheet(folder / "0.xyz");  // whose picture is of many colours
        sheet << "x y z red green blue\n";
        for (int i = 0; i < 160 * 120; ++i)
          sheet << fmt::format("{} {} 0 {} {} {}\n", i % 160, i / 160, 60 + i * 7919 % 190, i * 104729 % 50, i % 60);
        sheet.close();
        for (int k = 1; k < kFiles; ++k)
          std::filesystem::copy_file(folder / "0.xyz", folder / fmt::format("{}.xyz", k));
      },
      script + fmt::format("{:.1f} quit\n", 0.4 * kFiles));
  const auto& folder = played->folder.path();
  CHECK(std::distance(std::filesystem::directory_iterator(folder / "state" / "palpate" / "pictures"), {}) == kFiles);
  std::ofstream(folder / "again.txt") << inFolder(
      "0.3 screenshot %/start.png\n0.4 click 0.xyz\n0.9 state %/again.json\n1.0 quit\n", folder);
  const Outcome again =
      run(inFolder("cd % && XDG_STATE_HOME=%/state xvfb-run -a -s '-screen 0 1600x1000x24' ", folder) + program() +
          inFolder(" --quiet view --size 900x600 --backend cpu --script %/again.txt", folder));
  CHECK_MESSAGE(again.code == 0, again.text);
  CHECK(played->state("again.json")["model"] == (folder / "0.xyz").string());
  const auto [left, right] = brownColumns(Picture(folder / "start.png"));
  CHECK(right - left > 300);  // several in a row
}

TEST_CASE("the help finds a command by its words, and Enter carries it out") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 900x600 --backend cpu", sphereOf(1000), R"(
0.2 key f1
0.5 text hides all oth
0.7 key enter
0.9 state %/isolate.json
1.0 key f1
1.3 text orthographic
1.5 key enter
1.8 state %/ortho.json
1.9 key f1
2.2 text look: material
2.4 key enter
2.7 click metal
2.8 state %/closed.json
3.0 click material
3.2 click metal
3.4 key f1
3.6 key escape
3.8 state %/end.json
3.9 quit
)");
  const auto state = [&](const char* name) { return played->state(name); };
  CHECK(state("isolate.json")["mouse"] == "selecting");
  CHECK(state("isolate.json")["help"] == false);
  CHECK_FALSE(state("ortho.json")["camera"]["ortho"].is_null());
  CHECK(state("end.json")["errors"].size() == state("closed.json")["errors"].size());
  CHECK(state("end.json")["help"] == false);
}

TEST_CASE("each section of the panel is opened by its key, alone") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 900x600 --backend cpu", sphereOf(1000), R"(
0.1 key tab
0.2 key f2
0.4 click depth
0.5 key f3
0.7 click Outliers
0.8 key f4
1.0 click colour by
1.2 key escape
1.3 key f5
1.5 click stiffness
1.6 key f6
1.8 click triangles
1.9 key f7
2.1 click pick two positions
2.2 key f8
2.4 click Save to...
2.6 key escape
2.7 key f9
2.9 click file.ply
3.0 key escape
3.1 key f10
3.3 click Look for devices
3.5 state %/opened.json
3.6 click stiffness
3.9 state %/closed.json
4.0 quit
)");
  const auto opened = played->state("opened.json"), closed = played->state("closed.json");
  CHECK(opened["panels"] == true);
  CHECK(opened["errors"].empty());
  CHECK(opened["measuring"] == true);
  CHECK(says(std::string(closed["last_message"]), "'stiffness' cannot be clicked"));
}

TEST_CASE("panels and text have the scale of the screen, and the picture has all its pixels") {
  if (!hasDisplay()) return;
  if (std::system("command -v xprop > /dev/null") != 0) {
    MESSAGE("skipped: there is no xprop on this machine (package x11-utils)");
    return;
  }
  const ScratchFolder folder;
  makeSphere(folder.path(), 1000);
  std::ofstream(folder / "script.txt") << inFolder("0.3 state %/state.json\n0.3 screenshot %/picture.png\n0.6 quit\n",
                                                   folder.path());
  const std::string command = inFolder(
      "cd % && XDG_STATE_HOME=%/state xvfb-run -a -s '-screen 0 2000x1400x24 -noreset' sh -c \"xprop -root "
      "-f RESOURCE_MANAGER 8s -set RESOURCE_MANAGER 'Xft.dpi: 192' && " +
          program() + " --quiet view %/sphere.ply --size 1800x1200 --backend cpu --script %/script.txt\"",
      folder.path());
  REQUIRE(run(command).code == 0);
  CHECK(jsonOf(folder / "state.json")["scale"] == 2);
  const Picture picture(folder / "picture.png");
  CHECK(picture.width == 1800);
  // The panel at the right begins 17.1 times the size of the text from there, which is 14 pixels at scale 1.
  CHECK(picture.at(1800 - 34 * 14 + 4, 100) == picture.at(1800 - 20, 100));
  CHECK(picture.at(1800 - 35 * 14, 100) != picture.at(1800 - 20, 100));
}

TEST_CASE("at most 24 small pictures of models are kept, the newest ones") {
  if (!hasDisplay()) return;
  const auto pictures = [](const auto& folder) { return folder / "state" / "palpate" / "pictures"; };
  const auto played = playWell(
      "%/sphere.ply --size 480x360 --backend cpu",
      [&](const std::filesystem::path& folder) {
        makeSphere(folder, 1000);
        std::filesystem::create_directories(pictures(folder));
        for (int k = 0; k < 30; ++k) {
          const auto file = pictures(folder) / fmt::format("{}.png", k);
          std::ofstream(file) << "old";
          std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now() - std::chrono::hours(k));
        }
      },
      "0.5 quit\n");
  const auto& folder = pictures(played->folder.path());
  CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 24);
  CHECK(std::filesystem::exists(folder / "22.png"));
  CHECK_FALSE(std::filesystem::exists(folder / "23.png"));
}

TEST_CASE("F11 covers the screen, and brings the window back") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 900x600 --backend cpu", sphereOf(1000),
                               "0.2 key f11\n0.8 state %/full.json\n0.9 key f11\n1.5 state %/back.json\n1.6 quit\n");
  CHECK(played->state("full.json")["size"] == std::vector{1600, 1000});
  CHECK(played->state("back.json")["size"] == std::vector{900, 600});
}

TEST_CASE("the window opens where it was closed, and on a screen that is there") {
  if (!hasDisplay()) return;
  const ScratchFolder folder;
  const std::filesystem::path kept = folder / "palpate" / "window";
  std::filesystem::create_directories(kept.parent_path());
  std::ofstream(kept) << "first_steps no\nleft 5000\ntop 300\nwidth 640\nheight 480\n";
  const Outcome closed = run(fmt::format(
      "XDG_STATE_HOME={0} XDG_CONFIG_HOME={0} xvfb-run -a -s '-screen 0 1600x1000x24' timeout -s INT 15 {1} --quiet",
      folder.path().string(), program()));
  CHECK_MESSAGE(says(contentOf(kept), "left 960\ntop 300\nwidth 640\nheight 480\n"), closed.text);
}

}  // namespace palpate::view_tools_test
