// Opening the window without a command, and its message about a tool that is too small.
#include <fmt/format.h>

#include <fstream>

#include "tests/apps/window_play.hpp"
#include "tests/says.hpp"

namespace palpate::view_start_test {

TEST_CASE("palpate with models and no command opens the window, as view does") {
  if (!hasDisplay()) return;
  const ScratchFolder folder;
  makeSphere(folder.path(), 2000);
  works("--quiet make torus -n 2000 -o " + (folder / "torus.ply").string());
  std::ofstream(folder / "script.txt") << "0.3 state " << (folder / "state.json").string() << "\n0.4 quit\n";
  const std::string command = "XDG_STATE_HOME=" + folder.path().string() +
                              " xvfb-run -a -s '-screen 0 800x600x24' timeout 200 " + program() + " --quiet " +
                              (folder / "torus.ply").string() + " " + (folder / "sphere.ply").string() +
                              " --size 320x240 --script " + (folder / "script.txt").string();
  CHECK(std::system(command.c_str()) == 0);
  CHECK(jsonOf(folder / "state.json")["model"] == (folder / "torus.ply").string());
  CHECK(jsonOf(folder / "state.json")["size"] == std::vector<int>{320, 240});
  const Outcome none = palpate("nowhere.abc");
  CHECK_FALSE(none.text.find("no subcommand") != std::string::npos);
}

TEST_CASE("palpate without arguments opens the window, and without a display says what it needs") {
  const Outcome blind = run("env -u DISPLAY -u WAYLAND_DISPLAY " + program());
  CHECK(blind.code == 1);
  CHECK_MESSAGE(says(blind.text, "a window needs a display"), blind.text);
  CHECK(says(blind.text, "palpate render"));
  CHECK(blind.text.find('\n') + 1 == blind.text.size());  // one line
  const Outcome none = run("env -u DISPLAY -u WAYLAND_DISPLAY " + program() + " view nowhere.ply");
  CHECK(none.code == 1);
  CHECK_MESSAGE(says(none.text, "nowhere.ply"), none.text);
  CHECK(none.text.find("display") == std::string::npos);
  // Options of the window need no command either; others are refused as before.
  for (const std::string options : {"--size 320x240", "--size=320x240", "--edit push --quiet"})
    CHECK_MESSAGE(run("env -u DISPLAY -u WAYLAND_DISPLAY " + program() + " " + options).text == blind.text, options);
  const Outcome unknown = palpate("--sizes 320x240");
  CHECK(unknown.code == 2);
  CHECK_MESSAGE(says(unknown.text, "unknown option '--sizes'"), unknown.text);
  if (!hasDisplay()) return;
  const ScratchFolder folder;
  // The code of xvfb-run itself also tells how its display ended.
  const std::string home = folder.path().string();
  const Outcome open =
      run(fmt::format("XDG_STATE_HOME={0} XDG_CONFIG_HOME={0} xvfb-run -a sh -c "
                      "'timeout -s INT 4 {1}; echo $? > {0}/code'",
                      home, program()));
  std::string code;
  std::ifstream(folder / "code") >> code;
  CHECK_MESSAGE(code == "124", open.text);  // the window was still open
}

TEST_CASE("the window reports a tool smaller than the spacing, and no longer reports it once it is larger") {
  if (!hasDisplay()) return;
  std::string script = "0.2 state %/large.json\n";
  for (int i = 0; i < 12; ++i) script += "0.3 key [\n";
  script += "0.6 state %/small.json\n0.7 mouse 5 5\n";
  for (int i = 0; i < 12; ++i) script += "0.8 key ]\n";
  script += "1.1 key backspace\n1.2 key backspace\n1.3 state %/again.json\n1.4 quit\n";
  const auto played = playWell("%/sphere.ply --size 400x300 --edit push", sphereOf(2000), script);
  const std::string large = played->state("large.json")["last_message"];
  CHECK(large.find("smaller than the spacing") == std::string::npos);
  const std::string small = played->state("small.json")["last_message"];
  CHECK_MESSAGE(says(small, "is smaller than the spacing of the points, "), small);
  CHECK(says(small, "make its radius (key ]) "));
  CHECK(played->state("again.json")["last_message"] == "forces on");
}

}  // namespace palpate::view_start_test
