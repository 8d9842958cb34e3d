// Files that cannot be written completely: the error names file and reason, and nothing is left behind.
#include <set>

#include "tests/apps/program.hpp"
#include "tests/says.hpp"

namespace palpate::full_disk_test {

namespace {

std::set<std::string> namesIn(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    names.insert(entry.path().lexically_relative(folder).string());
  return names;
}

struct Case {
  std::string arguments;  // in a folder with s.ply
  std::string output;
  std::string older = {};  // its content before
};

}  // namespace

TEST_CASE("each command that exceeds the limit of file sizes says so, and leaves files as they were") {
  const std::string touch = "touch s.ply --backend cpu --duration 0.2 --edit push ";
  const std::vector<Case> cases{{"make sphere -n 20000 -o new.ply", "new.ply"},
                                {"make sphere -n 20000 -o new.ply", "new.ply", "old"},
                                {"convert s.ply new.las --force", "new.las", "old"},
                                {"convert s.ply new.npz", "new.npz"},
                                {"convert s.ply new.xyz", "new.xyz"},
                                {"convert s.ply new.3dgs.ply", "new.3dgs.ply"},
                                {touch + "--save new.ply", "new.ply", "old"},
                                {touch + "--trace new.csv", "new.csv", "old"},
                                {touch + "--trajectory new.csv", "new.csv"},
                                {touch + "--json new.json", "new.json"},
                                {touch + "--json new.json", "new.json", "old"},
                                {touch + "--picture new.png", "new.png", "old"},
                                {touch + "--log new.log", "new.log"},
                                {"info s.ply --json new.json", "new.json", "old"},
                                {"mesh s.ply --resolution 24 -o new.stl", "new.stl", "old"},
                                {"render s.ply --size 200x200 -o new.png", "new.png", "old"},
                                {"simulate drop --duration 0.01 --save new.ply", "new.ply"},
                                {"replay s.log --recover --save new.ply", "new.ply", "old"},
                                {"bench read s.ply --repeat 1 --limit 0.01 --json new.json", "new.json", "old"}};
  const ScratchFolder folder;
  const std::string in = "cd " + folder.path().string() + " && ";
  for (const std::string& first : {std::string("make sphere -n 3000 -o s.ply"), touch + "--log s.log"}) {
    const Outcome made = run(in + program() + " " + first);
    REQUIRE_MESSAGE(made.code == 0, made.text);
  }
  for (const auto& [arguments, output, older] : cases) {
    if (isLeftOut(arguments)) continue;
    CAPTURE(arguments);
    if (older.empty())
      std::filesystem::remove(folder / output);
    else
      std::ofstream(folder / output) << older;
    const auto before = namesIn(folder.path());
    // In blocks of 512 bytes: one is less than each of the files, except of the small ones.
    const bool isSmall = output.ends_with(".json") || output.ends_with(".log");
    const Outcome outcome =
        run(in + "ulimit -f " + (isSmall ? "0" : "1") + "; " + program() + " " + arguments + " < /dev/null");
    CHECK(says(outcome.text, output + ": cannot be written: File too large; raise the limit of file sizes"));
    CHECK(namesIn(folder.path()) == before);
    if (!older.empty()) CHECK(contentOf(folder / output) == older);
  }
}

TEST_CASE("an older session log stays if a new one cannot begin, and what a new one recorded stays") {
  const ScratchFolder folder;
  const std::string in = "cd " + folder.path().string() + " && ";
  const std::string touch = program() + " touch s.ply --backend cpu --edit push --duration 0.2 --log s.log";
  REQUIRE(run(in + program() + " make sphere -n 3000 -o s.ply && " + touch).code == 0);
  const std::string recorded = contentOf(folder / "s.log");
  CHECK(run(in + "ulimit -f 0; " + touch).code == 1);
  CHECK(contentOf(folder / "s.log") == recorded);
  CHECK(run(in + "ulimit -f 16; " + touch).code == 1);
  CHECK(run(in + program() + " replay s.log --recover --save r.ply").code == 0);
}

TEST_CASE("a program that is killed by the reader of its output leaves no temporary file") {
  const ScratchFolder folder;
  const std::string in = "cd " + folder.path().string() + " && mkdir t && TMPDIR=$PWD/t ";
  const Outcome ended = run(in + program() + " make sphere -n 200000 -o - --format ply --quiet | head -c 100 > head");
  CHECK_MESSAGE(ended.code == 0, ended.text);
  CHECK(contentOf(folder / "head").starts_with("ply\n"));
  CHECK(std::filesystem::is_empty(folder / "t"));
}

}  // namespace palpate::full_disk_test
