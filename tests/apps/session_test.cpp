// Undo, saving, session logs and their replay, through the program.
#include <cstddef>
#include <cstring>

#include "engine/core/checksum.hpp"
#include "engine/io/ply_reader.hpp"
#include "haptics/session_log.hpp"
#include "tests/apps/running_program.hpp"
#include "tests/labels.hpp"
#include "tests/says.hpp"

namespace palpate::session_test {

namespace {

/// A sphere, and a path that taps on it `taps` times, each time elsewhere.
struct Scene {
  explicit Scene(int taps = 3, int points = 20'000) {
    works("make sphere -n " + std::to_string(points) + " -o " + file("model.ply"));
    writePath("path.csv", taps);
  }
  void writePath(const std::string& name, int taps, double deepest = 47) const {
    std::ofstream path(folder / name);
    path << "t_s,x,y,z\n";
    for (int i = 0; i < taps; ++i) {
      const double begin_s = 0.5 * i;  // far enough apart to be strokes
      path << begin_s << "," << 5 * i << ",0,52\n" << begin_s + 0.08 << "," << 5 * i << ",0," << deepest << "\n";
      path << begin_s + 0.16 << "," << 5 * i << ",0,52\n";
    }
  }
  std::string file(const std::string& name) const { return (folder / name).string(); }
  std::string touch(const std::string& options, const std::string& path = "path.csv") const {
    return "touch " + file("model.ply") + " --edit push --yield-depth 0.3 --path " + file(path) + " " + options;
  }
  ScratchFolder folder;
};

Result replay(const Scene& scene, const std::string& options, int code = 0) {
  const Outcome outcome = palpate("replay " + options + " --json " + scene.file("replay.json"));
  REQUIRE_MESSAGE(outcome.code == code, outcome.text);
  return jsonOf(scene.folder / "replay.json");
}

void checkSame(const Result& json) {
  CAPTURE(json.dump());
  CHECK(json["compared_ticks"] == json["ticks"]);
  CHECK(json["force_ticks"] == 0);
  CHECK(json["largest_force_N"] == 0);
  CHECK(json["edit_ticks"] == 0);
  CHECK(json["end_points"] == 0);
  CHECK(json["ends_as_recorded"] == true);
}

// Replaces a text in the log's header, and updates the checksum.
void changeText(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& what,
                const std::string& with) {
  REQUIRE(what.size() == with.size());
  std::string content = contentOf(from);
  const std::size_t at = content.find(what);
  REQUIRE(at != std::string::npos);
  content.replace(at, what.size(), with);
  session_file::Header header;
  std::memcpy(&header, content.data(), sizeof header);
  header.checksum = 0;
  Checksum sum;
  sum.add(std::as_bytes(std::span(&header, 1)));
  sum.add(std::as_bytes(std::span(content.data() + sizeof header, header.textBytes)));
  header.checksum = sum.value();
  std::memcpy(content.data(), &header, sizeof header);
  std::ofstream(to, std::ios::binary) << content;
}

}  // namespace

TEST_CASE("with every stroke undone the saved file equals the model's; redone, the sculpted one's, byte for byte") {
  const Scene scene(3, 5'000);
  std::string backend;
  SUBCASE("cpu") { backend = "cpu"; }
  SUBCASE("vulkan") { backend = "vulkan"; }
  const auto save = [&](const std::string& name, const std::string& options, const std::string& path = "path.csv") {
    works(scene.touch("--backend " + backend + " --rate 125 --save " + scene.file(name) + " --json " +
                          scene.file("t.json") + " " + options,
                      path));
    return contentOf(scene.folder / name);
  };
  const std::string model = contentOf(scene.folder / "model.ply"), sculpted = save("sculpted.ply", "");
  CHECK(sculpted != model);
  CHECK(save("undone.ply", "--undo 3") == model);
  CHECK(jsonOf(scene.folder / "t.json")["moved_points"] == 0);
  CHECK(jsonOf(scene.folder / "t.json")["undo"]["undone"] == 3);
  CHECK(save("redone.ply", "--undo 3 --redo 3") == sculpted);
  CHECK(save("most.ply", "--undo 99 --redo 99") == sculpted);
  CHECK(jsonOf(scene.folder / "t.json")["undo"]["undone"] == 3);
  CHECK(jsonOf(scene.folder / "t.json")["undo"]["redone"] == 3);
  scene.writePath("two.csv", 2);
  CHECK(save("back.ply", "--undo 2 --redo 1") == save("two.ply", "", "two.csv"));
}

TEST_CASE("strokes beyond the undo memory are forgotten, with a message") {
  const Scene scene(3);
  checkEnds(0,
            scene.touch("--backend cpu --undo 3 --undo-memory 0.0001 --save " + scene.file("s.ply") + " --json " +
                        scene.file("t.json")),
            {"dropped strokes"});
  const auto json = jsonOf(scene.folder / "t.json")["undo"];
  CHECK(json["undone"] == 0);
  CHECK(json["strokes"] == 3);
  CHECK(json["forgotten"] == 3);
  CHECK(json["too_large"] == 3);
}

TEST_CASE("a recorded session is replayed identically: on the CPU, on the GPU, with a hand, friction and undo" *
          kMoreInFull) {
  const Scene scene(2, 5'000);
  for (const std::string options :
       {"--backend cpu", "--backend vulkan", "--backend cpu --device sim --friction 0.3 --surface sharp",
        "--backend vulkan --method indirect --bucket-key morton --stiffness 0.5 --rate 250",
        "--backend cpu --undo 2 --redo 1", "--backend vulkan --undo 2 --redo 1 --rate 250"}) {
    if (isLeftOut(options)) continue;
    if (options == "--backend vulkan" && !inFullTier()) continue;  // the last case covers it, with undo
    CAPTURE(options);
    works(scene.touch(options + " --log " + scene.file("log") + " --trace " + scene.file("a.csv") + " --save " +
                      scene.file("saved.ply")));
    const auto json = replay(scene, scene.file("log") + " --trace " + scene.file("b.csv"));
    checkSame(json);
    CHECK(json["ticks"] > 100);
    CHECK(json["edits"] > 100);
    CHECK(contentOf(scene.folder / "a.csv") == contentOf(scene.folder / "b.csv"));
    replay(scene, scene.file("log") + " --recover --save " + scene.file("recovered.ply"));
    CHECK(contentOf(scene.folder / "saved.ply") == contentOf(scene.folder / "recovered.ply"));
  }
}

TEST_CASE("a session that only feels is recorded and replayed identically") {
  const Scene scene(1);
  works("touch " + scene.file("model.ply") + " --backend cpu --path builtin:slide --log " + scene.file("log"));
  const auto json = replay(scene, scene.file("log"));
  checkSame(json);
  CHECK(json["edits"] == 0);
}

TEST_CASE("a replay that differs reports by how much, and exits with 1") {
  const Scene scene(2);
  works(scene.touch("--backend cpu --log " + scene.file("log")));
  SUBCASE("another stiffness: other forces, the same points") {
    changeText(scene.file("log"), scene.file("other"), "\"stiffness_N_per_mm\": 0.8", "\"stiffness_N_per_mm\": 0.7");
    const auto json = replay(scene, scene.file("other"), 1);
    CHECK(json["force_ticks"] > 50);
    CHECK(json["largest_force_N"] > 0.01);
    CHECK(json["edit_ticks"] == 0);
    CHECK(json["end_points"] == 0);
    CHECK(replay(scene, scene.file("other") + " --tolerance 1")["force_ticks"] == 0);
  }
  SUBCASE("another tool: other points") {
    changeText(scene.file("log"), scene.file("other"), "\"push_rate\": 0.1", "\"push_rate\": 0.2");
    const auto json = replay(scene, scene.file("other"), 1);
    CHECK(json["edit_ticks"] > 20);
    CHECK(json["end_points"] > 20);
    CHECK(json["first_difference_s"] < 0.08);
    CHECK(json["ends_as_recorded"] == true);
  }
  SUBCASE("an unknown option") {
    changeText(scene.file("log"), scene.file("other"), "\"push_rate\": 0.1", "\"gush_rate\": 0.1");
    checkEnds(1, "replay " + scene.file("other"), {"does not say how"});
  }
}

TEST_CASE("a truncated log is replayed up to its end, which is reported") {
  const Scene scene(6);
  works(scene.touch("--backend cpu --log " + scene.file("log")));
  const std::string whole = contentOf(scene.folder / "log");
  std::ofstream(scene.folder / "cut", std::ios::binary) << whole.substr(0, whole.size() - 5000);
  checkEnds(0, "replay " + scene.file("cut") + " --json " + scene.file("c.json"), {"it is truncated at byte"});
  const auto json = jsonOf(scene.folder / "c.json");
  CHECK(json["gaps"].size() == 1);
  CHECK(json["gaps"][0]["edits"].is_null());
  CHECK(json["whole_bytes"] < json["file_bytes"]);
  CHECK(json["ended"] == false);
  CHECK(json["ends_as_recorded"].is_null());
  CHECK(json["force_ticks"] == 0);
  CHECK(json["edit_ticks"] == 0);
  CHECK(json["compared_ticks"] > 100);
  replay(scene, scene.file("cut") + " --recover --save " + scene.file("r.ply"));
  CHECK(readPly(scene.folder / "r.ply").positions != readPly(scene.folder / "model.ply").positions);
}

TEST_CASE("a changed byte within a log costs its block, and replay reports the ticks and edits lost") {
  const Scene scene(6);
  works(scene.touch("--backend cpu --log " + scene.file("log")));
  std::string content = contentOf(scene.folder / "log");
  const auto whole = replay(scene, scene.file("log"));
  CHECK(whole["gaps"].empty());
  content[content.size() / 2] ^= 1;
  std::ofstream(scene.folder / "flipped", std::ios::binary) << content;
  checkEnds(0, "replay " + scene.file("flipped") + " --json " + scene.file("f.json"), {"are damaged: "});
  const auto json = jsonOf(scene.folder / "f.json");
  REQUIRE(json["gaps"].size() == 1);
  const auto gap = json["gaps"][0];
  CHECK(json["ended"] == true);
  CHECK(json["ticks"].get<int>() + gap["ticks"].get<int>() == whole["ticks"].get<int>());
  CHECK(json["edits"].get<int>() + gap["edits"].get<int>() == whole["edits"].get<int>());
  CHECK(gap["ticks"].get<int>() * 128 + gap["edits"].get<int>() * 36 < 17'000);
  CHECK(json["compared_ticks"] > 50);
  CHECK(json["compared_ticks"] < json["ticks"]);
  CHECK(json["force_ticks"] == 0);
  CHECK(json["edit_ticks"] == 0);
  CHECK(json["end_points"].is_null());
  CHECK(std::string(json["reason"]).find("missing") != std::string::npos);
  // Except for those in the gap, edited points keep their final positions.
  works("replay " + scene.file("log") + " --recover --save " + scene.file("a.ply"));
  works("replay " + scene.file("flipped") + " --recover --save " + scene.file("b.ply"));
  const PointCloud a = readPly(scene.folder / "a.ply"), b = readPly(scene.folder / "b.ply"),
                   model = readPly(scene.folder / "model.ply");
  std::size_t moved = 0, differing = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    moved += a.positions[i] != model.positions[i];
    differing += a.positions[i] != b.positions[i];
  }
  CHECK(moved > 50);
  CHECK(differing < moved / 2);
}

TEST_CASE("a log that cannot be replayed is reported in one clear line") {
  const Scene scene(1, 5'000);
  works(scene.touch("--backend cpu --log " + scene.file("log")));
  const auto fails = [&](const std::string& arguments, int code, const std::string& reason) {
    CAPTURE(arguments);
    const Outcome outcome = palpate(arguments);
    CHECK(outcome.code == code);
    CHECK_MESSAGE(outcome.text.find(reason) != std::string::npos, outcome.text);
  };
  const std::string log = scene.file("log"), model = scene.file("model.ply");
  fails("replay " + model, 1, "not a session log");
  fails("replay " + scene.file("none"), 1, "cannot be opened");
  fails("replay " + log + " --model " + scene.file("none.ply"), 1, "--model");
  works("make sphere -n 5001 -o " + scene.file("more.ply"));
  fails("replay " + log + " --model " + scene.file("more.ply"), 1, "5001 points");
  works("make torus -n 5000 -o " + scene.file("torus.ply"));
  fails("replay " + log + " --model " + scene.file("torus.ply"), 1, "has changed");
  std::string newer = contentOf(scene.folder / "log");
  session_file::Header header;
  std::memcpy(&header, newer.data(), sizeof header);
  constexpr std::uint32_t kNewer = session_file::kVersion + 1;
  for (const std::size_t copy : {std::size_t{0}, sizeof header + header.textBytes})
    std::memcpy(&newer[copy + offsetof(session_file::Header, version)], &kNewer, sizeof kNewer);
  std::ofstream(scene.folder / "newer", std::ios::binary) << newer;
  fails("replay " + scene.file("newer"), 1, "version " + std::to_string(kNewer));
  fails("replay " + log + " --recover", 2, "--save");
  fails("replay " + log + " --save x.ply", 2, "--recover");
  fails("replay " + log + " --tolerance -1", 2, "--tolerance");
  fails("touch " + model + " --undo 1", 2, "requires a brush (--edit)");
  fails("touch " + model + " --edit push --redo 1", 2, "--undo");
  fails("touch " + model + " --edit push --undo -1", 2, "--undo");
  fails("touch " + model + " --edit push --undo 1 --undo-memory 0", 2, "--undo-memory");
  fails("touch " + model + " --edit push --undo 1 --backend cuda", 2, "--undo");
  fails("touch " + model + " --log x --backend cuda", 2, "--log");
  fails("touch " + model + " --log " + scene.file("no/where"), 1, "where");
  fails("touch " + model + " --backend cpu --log " + model, 2, "is also named by model");
  if (std::filesystem::exists("/dev/full")) fails("touch " + model + " --log /dev/full --backend cpu", 1, "free some");
  // The file that the log names was moved, and is given explicitly.
  std::filesystem::rename(model, scene.file("moved.ply"));
  fails("replay " + log, 1, "model.ply");
  works("replay " + log + " --model " + scene.file("moved.ply"));
}

TEST_CASE("a real-time recording is compared only where it is reproducible, and its edits with its end") {
  const Scene scene(2, 5'000);
  for (const std::string options : {"--backend cpu", "--backend vulkan", "--backend vulkan --deterministic"}) {
    CAPTURE(options);
    works(scene.touch("--realtime --rate 250 " + options + " --log " + scene.file("log") + " --save " +
                      scene.file("s.ply")));
    const auto json = replay(scene, scene.file("log"));
    CHECK(json["ends_as_recorded"] == true);
    CHECK(json["force_ticks"] == 0);
    CHECK(json["edit_ticks"] == 0);
    CHECK(json["lost_ticks"] == 0);
    if (json["compared_ticks"] < json["ticks"]) {
      CHECK(json["reason"] != "");
      CHECK(json["end_points"].is_null());
    }
    replay(scene, scene.file("log") + " --recover --save " + scene.file("r.ply"));
    CHECK(contentOf(scene.folder / "s.ply") == contentOf(scene.folder / "r.ply"));
  }
}

TEST_CASE("a killed session loses at most its last second, and the rest is recovered and replayed") {
  const Scene scene(60, 2'000);  // 30 s of taps
  RunningProgram session(scene.touch("--backend cpu --realtime --log " + scene.file("log")), scene.folder / "said");
  REQUIRE_MESSAGE(session.waitForTicks(scene.folder / "log"), contentOf(scene.folder / "said"));
  std::this_thread::sleep_for(std::chrono::milliseconds(5000));
  REQUIRE_MESSAGE(WIFSIGNALED(session.wait(SIGKILL)), contentOf(scene.folder / "said"));
  const auto json = replay(scene, scene.file("log") + " --trace " + scene.file("t.csv"));
  CHECK(json["ended"] == false);
  const Outcome said = palpate("replay " + scene.file("log"));
  const bool tells = said.text.find("session's end; everything after") != said.text.npos;
  CHECK_MESSAGE((tells || says(said.text, "it is truncated at byte")), said.text);
  CHECK(json["edits"] > 0);                                   // a busy machine drops most of them
  CHECK(readTrace(scene.folder / "t.csv").back().t_s > 1.9);  // of 5 s and more, on a busy machine
  replay(scene, scene.file("log") + " --recover --save " + scene.file("r.ply"));
  CHECK(readPly(scene.folder / "r.ply").positions != readPly(scene.folder / "model.ply").positions);
}

TEST_CASE("an interrupted session has a complete log, undo included") {
  const Scene scene(60, 2'000);
  RunningProgram session(scene.touch("--backend cpu --realtime --undo 99 --log " + scene.file("log") + " --save " +
                                     scene.file("saved.ply")),
                         scene.folder / "said");
  REQUIRE_MESSAGE(session.waitForTicks(scene.folder / "log"), contentOf(scene.folder / "said"));
  CHECK(session.wait(SIGINT) != 0);
  CHECK(contentOf(scene.folder / "said").find("interrupted") != std::string::npos);
  CHECK(contentOf(scene.folder / "saved.ply") == contentOf(scene.folder / "model.ply"));
  const auto json = replay(scene, scene.file("log"));
  CHECK(json["ended"] == true);
  CHECK(json["ends_as_recorded"] == true);
}

TEST_CASE("on a full disk the log ends, the session continues, and existing files stay") {
  const Scene scene(12);
  std::ofstream(scene.folder / "saved.ply") << "old";
  const auto limited = [&](const std::string& options) {
    const std::string command = "bash -c \"ulimit -f 200; " + program() + " " +
                                scene.touch("--backend cpu " + options) + "\" >" + scene.file("said") + " 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));
  };
  CHECK(limited("--save " + scene.file("saved.ply")) == 1);
  std::string said = contentOf(scene.folder / "said");
  CHECK_MESSAGE(said.find("saved.ply: cannot be written") != std::string::npos, said);
  CHECK(said.find("raise the limit of file sizes") != std::string::npos);
  CHECK(contentOf(scene.folder / "saved.ply") == "old");

  CHECK(limited("--log " + scene.file("log")) == 1);
  said = contentOf(scene.folder / "said");
  CHECK_MESSAGE(said.find("log: cannot be written") != std::string::npos, said);
  REQUIRE(said.find("the session continues") != said.npos);
  CHECK(said.find("the session continues") == said.rfind("the session continues"));  // once
  CHECK(said.find("are missing in it") != std::string::npos);
  CHECK(said.find("peak force") != std::string::npos);
  const auto json = replay(scene, scene.file("log"));
  CHECK(json["compared_ticks"] > 100);
  CHECK(json["edits"] > 1000);
  CHECK(json["ended"] == true);
  checkEnds(0, "replay " + scene.file("log") + " --recover --save " + scene.file("r.ply"), {"they were not written"});
  CHECK(readPly(scene.folder / "r.ply").positions != readPly(scene.folder / "model.ply").positions);
  for (const auto& entry : std::filesystem::directory_iterator(scene.folder.path()))
    CHECK(entry.path().extension() != ".tmp");
}

}  // namespace palpate::session_test
