// Opening in the window: reading can be stopped, more memory than is free is asked about, and the model before stays in
// the picture until the next one is there.
#include <utility>

#include "engine/core/clock.hpp"
#include "tests/apps/running_program.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/says.hpp"

namespace palpate::view_reading_test {

namespace {

// Text that takes seconds to read.
void writeLong(const std::filesystem::path& file) {
  constexpr int kRows = 3'000'000;
  std::ofstream out(file);
  out << "x y z\n";
  std::string block;
  for (int i = 0; i < kRows; ++i) {
    block += fmt::format("{} {} {}\n", i % 1731, i / 1731, (i * 7919LL) % 13);
    if (i % 10'000 == 9'999) out << std::exchange(block, {});
  }
}

// Declares, and seems to have, more points than any memory holds; the disk holds nothing of it.
void writeHuge(const std::filesystem::path& file) {
  constexpr std::uint64_t kPoints = 4'000'000'000;
  const std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n",
      kPoints);
  std::ofstream(file) << header;
  std::filesystem::resize_file(file, header.size() + 12 * kPoints);
}

}  // namespace

TEST_CASE("reading a file in the window is stopped by Esc and by a button, and the model before stays") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/sphere.ply --size 480x360 --backend cpu",
      [](const auto& folder) {
        makeSphere(folder, 2000);
        writeLong(folder / "long.xyz");
      },
      R"(
0.2 impatient
0.3 drop %/long.xyz
0.5 state %/reading.json
0.6 key escape
0.7 patient
0.9 state %/escaped.json
1.0 impatient
1.1 drop %/long.xyz
1.3 state %/again.json
1.4 click Cancel
1.5 patient
1.7 state %/cancelled.json
1.8 quit
)");
  for (const char* name : {"reading.json", "again.json"}) CHECK_FALSE(played->state(name)["loading"].is_null());
  for (const char* name : {"escaped.json", "cancelled.json"}) {
    const auto state = played->state(name);
    CAPTURE(name);
    CHECK(state["loading"].is_null());
    CHECK(says(state["model"], "sphere.ply"));
    CHECK(says(state["last_message"], "long.xyz was not opened: stopped"));
    CHECK(state["errors"].empty());
  }
}

TEST_CASE("a window that reads a file ends soon after SIGTERM") {
  if (!hasDisplay()) return;
  const ScratchFolder folder;
  writeLong(folder / "long.xyz");
  std::ofstream(folder / "said").flush();
  std::ofstream(folder / "window.sh") << inFolder("cd % && echo $$ > pid && XDG_STATE_HOME=%/state exec " +
                                                      std::filesystem::absolute(program()).string() +
                                                      " view long.xyz --size 480x360",
                                                  folder.path());
  std::thread display([&] { run(inFolder("xvfb-run -a sh %/window.sh > %/said 2>&1; touch %/ended", folder.path())); });
  // A long read is reported after a second.
  const Stopwatch since;
  while (since.elapsed_s() < 60 && contentOf(folder / "said").find("long.xyz: ") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ::kill(std::stoi(contentOf(folder / "pid")), SIGTERM);
  const Stopwatch after;
  while (after.elapsed_s() < 60 && !std::filesystem::exists(folder / "ended"))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK_MESSAGE(after.elapsed_s() < 1.5, after.elapsed_s());  // of which xvfb-run takes the most
  display.join();
}

TEST_CASE("a file that needs more memory than is free is refused with the number, unless --force reads it") {
  const ScratchFolder folder;
  writeHuge(folder / "huge.ply");
  const std::string huge = (folder / "huge.ply").string();
  for (const std::string& command :
       {"info " + huge, "convert " + huge + " " + (folder / "o.ply").string(), "touch " + huge + " --backend cpu",
        "mesh " + huge + " -o " + (folder / "m.ply").string()})
    checkEnds(1, command,
              {"huge.ply: needs about ", " GB of memory, and ", " are free; --force reads it nevertheless"});
  const Outcome forced = run("ulimit -v 2000000; " + program() + " --force --threads 1 info " + huge + " 2>&1");
  CHECK(forced.code == 1);
  CHECK(says(forced.text, "out of memory"));  // it was tried
  // In a terminal it is asked.
  const Outcome asked = run("echo n | script -qec '" + program() + " info " + huge + "' /dev/null");
  CHECK(says(asked.text, "are free. Read it nevertheless? [y/N]"));
  CHECK(says(asked.text, "--force reads it nevertheless"));
}

TEST_CASE("the window asks before it reads a file that needs more memory than is free") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/sphere.ply --size 480x360 --backend cpu",
      [](const auto& folder) {
        makeSphere(folder, 2000);
        writeHuge(folder / "huge.ply");
      },
      R"(
0.2 drop %/huge.ply
0.5 state %/refused.json
0.6 ask
0.7 drop %/huge.ply
1.0 state %/asked.json
1.1 key enter
1.3 state %/cancelled.json
1.4 quit
)");
  CHECK(says(played->state("refused.json")["last_message"], "--force reads it nevertheless"));
  CHECK(played->state("asked.json")["asks_about_memory"] == true);
  const auto cancelled = played->state("cancelled.json");
  CHECK(cancelled["asks_about_memory"] == false);
  CHECK(cancelled["loading"].is_null());
  CHECK(says(cancelled["model"], "sphere.ply"));
}

TEST_CASE("the picture of a model stays until the next one is there, and strokes are refused meanwhile") {
  if (!hasDisplay()) return;
  std::string script =
      "0.2 mouse 132 180\n0.3 key space down\n0.5 screenshot %/before.png\n0.6 impatient\n"
      "0.7 drop %/torus.ply\n";
  constexpr int kLooks = 60;
  for (int i = 0; i < kLooks; ++i)
    script += fmt::format(
        "{0:.2f} button left down\n{0:.2f} state %/{1}.json\n{0:.2f} screenshot %/{1}.png\n"
        "{2:.2f} button left up\n",
        0.75 + 0.1 * i, i, 0.8 + 0.1 * i);
  const auto played = playWell(
      "%/sphere.ply --size 480x360 --backend vulkan --edit push",
      [](const auto& folder) {
        makeSphere(folder, 30'000);
        works("--quiet make torus -n 30000 -o " + (folder / "torus.ply").string());
      },
      script + "7.5 patient\n7.9 state %/after.json\n8 quit\n");
  const Picture before(played->folder.path() / "before.png");
  const auto background = before.at(222, 20);
  int waited = 0;
  bool isRefused = false;
  for (int i = 0; i < kLooks; ++i) {
    const auto state = played->state(fmt::format("{}.json", i));
    CHECK_FALSE(state["model"].is_null());
    if (state["waits"] == "") continue;
    ++waited;
    isRefused |= says(state["messages"].dump(), "no stroke: torus.ply is being opened");
    const Picture now(played->folder.path() / fmt::format("{}.png", i));
    CHECK(now.at(132, 180) != background);
  }
  CHECK(waited > 1);
  CHECK(isRefused);
  CHECK(says(played->state("after.json")["model"], "torus.ply"));
}

}  // namespace palpate::view_reading_test
