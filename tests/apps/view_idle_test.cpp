// Processor time of a window without input.
#include "tests/apps/window_play.hpp"
#include "tests/labels.hpp"

namespace palpate::view_idle_test {

namespace {

// Percent of a core in the quietest second of the first twenty: how soon it comes to rest depends on the machine.
double restingPercent(const std::string& arguments) {
  const ScratchFolder folder;
  makeSphere(folder.path(), 3000);
  std::ofstream(folder / "measure.sh") << inFolder(
      std::filesystem::absolute(program()).string() + " --quiet view --size 900x600 " + arguments +
          " & P=$!\nspent() { awk '{print $14 + $15}' /proc/$P/stat; }\nbest=100\nfor i in $(seq 20); do\n"
          "  before=$(spent); sleep 1; now=$(spent)\n  [ \"$now\" ] || exit 1\n"
          "  [ $((now - before)) -lt $best ] && best=$((now - before))\n  [ $i -gt 2 ] && [ $best -le 1 ] && break\n"
          "done\nkill $P; wait $P\necho $best > %/best\n",
      folder.path());
  const std::string command = "cd " + folder.path().string() + " && XDG_STATE_HOME=" + folder.path().string() +
                              " xvfb-run -a timeout 60 sh measure.sh > said 2>&1";
  std::system(command.c_str());
  REQUIRE_MESSAGE(std::filesystem::exists(folder / "best"), contentOf(folder / "said"));
  return std::stod(contentOf(folder / "best"));  // hundredths of a second in a second
}

}  // namespace

TEST_CASE("a window without input takes less than 3 % of a core with a model" * kClock) {
  if (!hasDisplay()) return;
  CHECK(restingPercent("%/sphere.ply") <= 2);
}

TEST_CASE("the start screen takes at most 1 % of a core" * kClock) {
  if (!hasDisplay()) return;
  CHECK(restingPercent("--device mouse") <= 1);
}

}  // namespace palpate::view_idle_test
