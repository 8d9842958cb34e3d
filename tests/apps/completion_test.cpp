// Completion in the shell.
#include <filesystem>
#include <set>
#include <sstream>

#include "tests/apps/program.hpp"
#include "tests/says.hpp"
#include "tests/source_folder.hpp"

namespace palpate::completion_test {

TEST_CASE("a shell completes commands, options and values, also after options of all commands") {
  const auto offers = [](const std::string& words, const std::string& expected) {
    if (isLeftOut(words)) return;
    const Outcome offered = palpate("complete " + words);
    CHECK(offered.code == 0);
    CHECK_MESSAGE(offered.text == expected, words);
  };
  offers("tou", "touch\n/\n");
  offers("--gpu x --quiet ben", "bench\n/\n");
  offers("bench coe", "coexist\n");
  offers("bench edit --qui", "--quiet\n");
  offers("touch x.ply --edit p", "paint\npush\n");
  offers("touch --edit=gr", "--edit=grab\n");
  offers("touch --edit = gr", "grab\n");
  offers("make s", "sculpture\nsphere\n");
  offers("simulate d", "dam\ndrop\n/ .json\n");
  if (hasScenes())
    for (const std::string command : {"touch", "view", "render", "info", "serve"}) {
      const std::string found = palpate("complete -- " + command + " sta").text;
      CHECK_MESSAGE(found.starts_with("statue in water\n/ "), found);
    }
  offers("touch --path ''", "builtin:orbit\nbuiltin:press\nbuiltin:scan\nbuiltin:slide\nbuiltin:stir\n/ .csv\n");
  offers("touch --path builtin : pr", "press\n/ .csv\n");  // as bash splits it
  offers("touch --path builtin:pr", "builtin:press\n/ .csv\n");
  offers("touch x.ply --trace ''", "/ .csv\n");
  offers("touch x.ply --picture ''", "/ .png .jpg\n");
  offers("touch x.ply --stiffness ''", "");  // a number
  offers("touch --security ''", "/ /\n");
  offers("--threads 2 --json - --quiet touch x.ply --device s", "sim\n");
  offers("bench build so", "sort\n");  // several benches in one call
  offers("bench step --backend vulkan,c", "vulkan,cpu\nvulkan,cuda\n");
  offers("--validate=c", "--validate=core\n");
  CHECK(says(palpate("complete -- mesh m.ply -o ''").text, ".stl"));
  CHECK(says(palpate("complete -- convert ''").text, ".laz"));
  offers("touch x.ply --stiffne", "--stiffness\n");
  offers("-- tou", "touch\n/\n");  // as the scripts call it: a word after -- may be the name of a shell
  // The completion of bash, and the files of a folder beside commands.
  const ScratchFolder folder;
  for (const char* name : {"tower.ply", "tower.csv", "tower.pdf"}) std::ofstream(folder / name) << "ply\n";
  std::filesystem::create_directory(folder / "folder");
  const std::string script = (sourceFolder() / "third_party/debian/palpate.bash").string();
  const Outcome bash = run("cd " + folder.path().string() +
                           " && bash -c 'show() { echo $(printf \"%s\\n\" \"${COMPREPLY[@]}\" | sort); }; source " +
                           script + "; COMP_WORDS=(" + program() + " to); COMP_CWORD=1; _palpate; show; COMP_WORDS=(" +
                           program() + " touch --edit = ca); COMP_CWORD=4; _palpate; show; COMP_WORDS=(" + program() +
                           " render to); COMP_CWORD=2; _palpate; show; COMP_WORDS=(" + program() +
                           " touch --trace \"\"); COMP_CWORD=3; _palpate; show'");
  CHECK(bash.text == "touch tower.csv tower.pdf tower.ply\ncarve\ntower.csv tower.ply\nfolder tower.csv\n");
}

TEST_CASE("each value that the help lists for an option is completed") {
  std::size_t offered = 0;
  for (const std::string command : {"touch", "convert", "mesh", "render", "bench touch"}) {
    if (isLeftOut(command)) continue;
    std::istringstream help(palpate(command + " --help").text);
    for (std::string line; std::getline(help, line);) {
      const std::size_t name = line.find("--"), from = line.find(":{"), to = line.find('}');
      if (name == line.npos || from == line.npos || to == line.npos || from < name) continue;
      const std::string option = line.substr(name, line.find_first_of(" ,", name) - name);
      std::string words = line.substr(from + 2, to - from - 2);
      std::ranges::replace(words, ',', '\n');
      const Outcome outcome = palpate("complete -- " + command + " " + option + " ''");
      const auto sorted = [](const std::string& text) {
        std::istringstream in(text);
        std::set<std::string> all;
        for (std::string word; std::getline(in, word);) all.insert(word);
        return all;
      };
      CAPTURE(line);
      CHECK(sorted(outcome.text) == sorted(words));
      ++offered;
    }
  }
  CHECK(offered > (isLeftOut("bench") ? 15 : 20));
}

TEST_CASE("the zsh script that the program prints completes commands, values and files") {
  CHECK(palpate("complete bash").text == contentOf(sourceFolder() / "third_party/debian/palpate.bash"));
  const std::string script = palpate("complete zsh").text;
  CHECK(script == contentOf(sourceFolder() / "third_party/debian/palpate.zsh"));
  CHECK(says(script, "#compdef palpate\n"));
  CHECK(says(script, " complete -- "));
  if (run("command -v zsh").code != 0 || isLeftOut("bench")) {
    MESSAGE("skipped: zsh is not installed, or this palpate has no benches");
    return;
  }
  const ScratchFolder folder;
  std::ofstream(folder / "_palpate") << script;
  std::ofstream(folder / "try.zsh") << "compdef() { print compdef $@ }\ncompset() { print compset $@ }\n"
                                       "compadd() { shift; print -l -- $@ }\n_files() { print FILES $@ }\n"
                                       "source ./_palpate\n"
                                       "words=(" +
                                           program() +
                                           " touch --edit=gr); CURRENT=3; _palpate\n"
                                           "words=(" +
                                           program() +
                                           " to); CURRENT=2; _palpate\n"
                                           "words=(" +
                                           program() +
                                           " bench ''); CURRENT=3; _palpate | head -2\n"
                                           "words=(" +
                                           program() + " touch --trace ''); CURRENT=4; _palpate\n";
  const Outcome zsh = run("cd " + folder.path().string() + " && zsh -f try.zsh");
  CHECK(zsh.text ==
        "compdef _palpate palpate\n--edit=grab\ntouch\ncompset -P --*=\nFILES\nbuild\ncoexist\ncompset -P --*=\nFILES "
        "-g *(.csv)(-.)\n");
}

}  // namespace palpate::completion_test
