// A model that one program serves and others join, through the program. Not for a build without PALPATE_NETWORK.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <future>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "engine/cloud/length_unit.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/apps/running_program.hpp"
#include "tests/apps/serving.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/labels.hpp"

namespace palpate::sharing_test {

TEST_CASE("a joined model is felt like its file, byte for byte, drawn, recorded, and replayed with the file") {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const std::string model = (folder / "far.ply").string(), at = (folder / "r.json").string();
  works("make bumpy-sphere -n 6000 --center 450000,-300000,1000 -o " + model);
  Serving serving(model + " --name 'the city' --read-only --mm-per-unit 2 --json " + at, folder / "said");
  for (const std::string backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    const std::string own = (folder / "own.csv").string(), joined = (folder / "joined.csv").string();
    const std::string options = " --backend " + backend + " --duration 0.2 --trace ";
    works("touch " + model + " --mm-per-unit 2" + options + own);
    works("touch --join 'the city'" + domain() + options + joined + " --log " + (folder / "log").string());
    CHECK(contentOf(joined) == contentOf(own));
    CHECK(contentOf(own).size() > 10'000);
    const Outcome alone = palpate("replay " + (folder / "log").string());
    CHECK(alone.code == 1);
    CHECK(alone.text.find("served by another program") != std::string::npos);
    works("replay " + (folder / "log").string() + " --model " + model);
  }
  works("render --join 'the city'" + domain() + " --size 320x180 -o " + (folder / "p.png").string());
  CHECK(contentOf(folder / "p.png").substr(1, 3) == "PNG");
  const Outcome brush = palpate("touch --join 'the city'" + domain() + " --backend cpu --edit push");
  CHECK(brush.code == 1);
  CHECK(brush.text.find("the city: the model is served read-only") != std::string::npos);
  const Outcome listed = palpate("doctor --network" + domain());
  CHECK(listed.text.find("the city: 6000 points of far.ply") != std::string::npos);
  const Outcome second = palpate("serve " + model + " --name 'the city'" + domain());
  CHECK(second.code == 1);
  CHECK(second.text.find("served already") != std::string::npos);
  CHECK(serving.program.wait(SIGINT) == 0);
  const Result report = jsonOf(at);
  CHECK(report["clients"] == 4);
  CHECK(report["refused"] == 0);
  // Later clients do not find it any more.
  CHECK(palpate("doctor --network" + domain()).text.find("the city") == std::string::npos);
}

TEST_CASE(
    "a joined LAZ keeps its unit and coordinates, and what stays with the server is named before anything is written") {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make bumpy-sphere -n 4000 --center 637000,4877000,400 -o " + in("m.ply"));
  PointCloud cloud = readCloud(in("m.ply")).cloud;
  cloud.normals.clear();
  cloud.exactPositions.clear();
  cloud.extra.push_back({"intensity", ScalarType::u16, std::vector<std::byte>(2 * cloud.size(), std::byte{1})});
  setUnit(cloud.storedAs.comments, LengthUnit::foot);
  const CoordinateGrid grid{.step = DVec3(0.01), .offset = DVec3(637000, 4877000, 0)};
  cloud.storedAs.grid = grid;
  for (Vec3& place : cloud.positions) place = Vec3(grid.at(grid.nearest(cloud.origin + DVec3(place))) - cloud.origin);
  writeCloud(in("m.laz"), cloud);
  Serving serving(in("m.laz") + " --name city", folder / "said");
  const Outcome joined =
      palpate("touch --join city" + domain() + " --backend cpu --edit push --undo 1 --save " + in("out.laz"));
  CHECK(joined.code == 0);
  const std::size_t named = joined.text.find("these stay with the server: intensity;");
  CHECK_MESSAGE(named != std::string::npos, joined.text);
  const PointCloud scan = readCloud(in("m.laz")).cloud, out = readCloud(in("out.laz")).cloud;
  CHECK(unitSaidIn(out.storedAs.comments) == LengthUnit::foot);
  CHECK_FALSE(out.hasNormals());
  REQUIRE(out.size() == scan.size());
  bool isSame = true;
  for (std::size_t i = 0; i < out.size(); ++i) isSame &= out.fileCoordinates(i) == scan.fileCoordinates(i);
  CHECK(isSame);
}

TEST_CASE("two hands sculpt a served model, and all three programs and later clients have the same points") {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make bumpy-sphere -n 8000 -o " + in("m.ply"));
  Serving serving(in("m.ply") + " --name clay --save " + in("end.ply") + " --json " + in("s.json"), folder / "said");
  const std::string joins = "--join clay" + domain();
  RunningProgram left(
      "touch " + joins + " --hand-name left --backend cpu --realtime --duration 3 --edit push --penetration 4 --save " +
          in("left.ply") + " --json " + in("l.json"),
      folder / "left.said");
  RunningProgram right(
      "touch " + joins +
          " --hand-name right --backend vulkan --path builtin:slide --duration 0.4 --edit paint --save " +
          in("right.ply") + " --json " + in("r.json"),
      folder / "right.said");
  for (RunningProgram* hand : {&left, &right}) hand->waitFor([&] { return hand->ended(); });
  CAPTURE(contentOf(folder / "left.said"));
  CAPTURE(contentOf(folder / "right.said"));
  const Result l = jsonOf(in("l.json"))["shared"], r = jsonOf(in("r.json"))["shared"];
  CHECK(l["sent"] > 100);
  CHECK(r["sent"] > 20);
  CHECK(l["delivered"] == true);
  CHECK(r["delivered"] == true);
  // The last hand, and a client without edits, have the edits of both.
  works("touch " + joins + " --backend cpu --duration 0.05 --save " + in("later.ply") + " --json " + in("later.json"));
  const Result later = jsonOf(in("later.json"))["shared"];
  CHECK(later["same"] == true);
  CHECK(later["sent"] == 0);
  // Undo of a stroke keeps others' edits.
  works("touch " + joins + " --backend cpu --duration 0.3 --edit push --penetration 6 --undo 1 --save " +
        in("undone.ply") + " --json " + in("undone.json"));
  const Result undone = jsonOf(in("undone.json"));
  CHECK(undone["shared"]["sent"] > 10);
  CHECK(undone["shared"]["same"] == true);
  CHECK(pointsOf(in("undone.ply")) == pointsOf(in("later.ply")));
  works("render " + joins + " --size 320x180 -o " + in("p.png"));
  CHECK(serving.program.wait(SIGINT) == 0);
  CHECK(pointsOf(in("end.ply")) == pointsOf(in("later.ply")));
  CHECK(pointsOf(in("m.ply")) != pointsOf(in("end.ply")));
  const Result served = jsonOf(in("s.json"));
  CHECK(served["sculptors"] == 3);
  CHECK(served["states"] == l["sent"].get<int>() + r["sent"].get<int>() + undone["shared"]["sent"].get<int>());
  CHECK(served["refused"] == 0);
  CHECK(served["duplicate_pieces"] == 0);
}

TEST_CASE("a window that joins a read-only model shows it, and reports that it takes no brush") {
  if (!isBuilt() || !hasDisplay()) return;
  const ScratchFolder folder;
  const auto in = [&](const std::string& name) { return (folder / name).string(); };
  works("make bumpy-sphere -n 5000 -o " + in("m.ply"));
  Serving still(in("m.ply") + " --name still --read-only", folder / "still.said");
  std::ofstream(in("still.txt")) << "0.1 key 2\n0.2 state " << in("still.json") << "\n0.2 quit\n";
  CHECK(
      std::system(("XDG_STATE_HOME=" + in("still") + " xvfb-run -a " + program() + " view --join still" + domain() +
                   " --backend cpu --size 480x360 --script " + in("still.txt") + " > " + in("still.txt.said") + " 2>&1")
                      .c_str()) == 0);
  const Result state = jsonOf(in("still.json"));
  CHECK(state["points"] == 5000);
  CHECK(state["last_message"] == "still: the model is served read-only; serve it without --read-only to sculpt it");
}

TEST_CASE("two windows on one model show each other's hands, and the edits of both" * kFull) {
  if (!isBuilt() || !hasDisplay()) return;
  const ScratchFolder folder;
  const auto in = [&](const std::string& name) { return (folder / name).string(); };
  works("make bumpy-sphere -n 20000 -o " + in("m.ply"));
  Serving serving(in("m.ply") + " --name clay --save " + in("end.ply"), folder / "said");
  const auto view = [&](const std::string& name, const std::string& place) {
    // A script runs as fast as its pictures are drawn, so that one window may end before the other starts: each waits
    // until the other sculpts, and lets go once the other has seen it.
    const std::string other = name == "Ada" ? "Bert" : "Ada";
    std::ofstream(in(name + ".txt")) << "2 key T\n2 mouse " << place << "\n2.2 key 2\n2.3 button left down\n"
                                     << "2.5 state " << in(name + ".begun") << "\n2.5 await " << in(other + ".begun")
                                     << "\n"
                                     << "5 click link\n5.5 click link\n"
                                     << "8 screenshot " << in(name + ".png") << "\n8 state " << in(name + ".json")
                                     << "\n8 await " << in(other + ".json") << "\n8 button left up\n9 quit\n";
    return std::system(("XDG_STATE_HOME=" + in(name) + " xvfb-run -a " + program() + " view --join clay --hand-name " +
                        name + domain() + " --backend cpu --realtime --script " + in(name + ".txt") + " > " +
                        in(name + ".said") + " 2>&1")
                           .c_str());
  };
  std::future<int> ada = std::async(std::launch::async, [&] { return view("Ada", "600 380"); });
  CHECK_MESSAGE(view("Bert", "560 250") == 0, contentOf(in("Bert.said")));
  CHECK_MESSAGE(ada.get() == 0, contentOf(in("Ada.said")));
  for (const auto& [name, other] : {std::pair("Ada", "Bert"), std::pair("Bert", "Ada")}) {
    const Result state = jsonOf(in(std::string(name) + ".json"));
    CAPTURE(state.dump());
    REQUIRE(state["other_hands"].size() == 1);
    CHECK(state["other_hands"][0]["name"] == other);
    CHECK(state["other_hands"][0]["sculpts"] == true);
    CHECK(state["shared"]["sent"] > 10);
    CHECK(state["shared"]["received"] > 10);
    CHECK(state["shared"]["round_trip_ms"] > 0);
    CHECK(state["shared"]["lost_percent"] < 50);
    CHECK(state["shared"]["age_s"] < 3);
    CHECK(state["shared"]["force_share"] == 1);
    CHECK(contentOf(in(std::string(name) + ".png")).substr(1, 3) == "PNG");
  }
  CHECK(serving.program.wait(SIGINT) == 0);
  CHECK(pointsOf(in("m.ply")) != pointsOf(in("end.ply")));
}

TEST_CASE("a window, a program with only nearby points and one with all points show each other's hands" * kMoreInFull) {
  if (!isBuilt() || !hasDisplay()) return;
  const ScratchFolder folder;
  const auto in = [&](const std::string& name) { return (folder / name).string(); };
  works("make bumpy-sphere -n 8000 -o " + in("m.ply"));
  const std::vector<std::string> ways = byTier<std::vector<std::string>>({""}, {"", " --read-only"});
  for (const std::string& readOnly : ways) {
    CAPTURE(readOnly);
    for (const char* name : {"a.json", "b.json", "b.png", "t.json"}) std::filesystem::remove(in(name));
    Serving serving(in("m.ply") + " --name felt" + readOnly, folder / "said");
    // The window keeps its hand on the model until the other two have seen it.
    std::ofstream(in("w.txt")) << "0.3 key tab\n0.5 key T\n0.5 mouse 240 180\n0.8 button left down\n1 state "
                               << in("a.json") << "\n1 await " << in("go") << "\n1.5 screenshot " << in("b.png")
                               << "\n1.5 state " << in("b.json") << "\n1.5 await " << in("t.json")
                               << "\n1.5 button left up\n1.8 quit\n";
    std::filesystem::remove(in("go"));
    std::future<int> window = std::async(std::launch::async, [&] {
      return std::system(("XDG_STATE_HOME=" + in("home") + " timeout 200 xvfb-run -a " + program() +
                          " view --join felt --partial --hand-name Ada" + domain() +
                          " --backend cpu --realtime --size 480x360 --script " + in("w.txt") + " > " + in("w.said") +
                          " 2>&1")
                             .c_str());
    });
    REQUIRE_MESSAGE(serving.program.waitFor([&] { return std::filesystem::exists(in("a.json")); }),
                    contentOf(in("w.said")));
    const std::string touch =
        "touch --join felt" + domain() + " --backend cpu --realtime --path builtin:press --duration ";
    RunningProgram bert(touch + "200 --partial --hand-name Bert --hand path=builtin:slide --json " + in("t.json"),
                        folder / "bert.said");
    RunningProgram carla(touch + "200 --hand-name Carla --json " + in("c.json"), folder / "carla.said");
    const auto areNear = [&] {
      const std::string said = contentOf(folder / "said"), part = "streams the points around its hands";
      const std::size_t first = said.find(part);
      return first != std::string::npos && said.rfind(part) != first;
    };
    CHECK_MESSAGE(bert.waitFor(areNear), contentOf(folder / "said"));
    CHECK(carla.waitFor([&] { return contentOf(folder / "carla.said").find("points of") != std::string::npos; }));
    std::this_thread::sleep_for(std::chrono::seconds(1));  // time for each to discover the others
    std::ofstream(in("go")) << "now";
    REQUIRE_MESSAGE(serving.program.waitFor([&] { return std::filesystem::exists(in("b.json")); }),
                    contentOf(in("w.said")));
    CHECK(WEXITSTATUS(bert.wait(SIGINT)) == 130);  // interrupted: its results are written
    CHECK(WEXITSTATUS(carla.wait(SIGINT)) == 130);
    CHECK_MESSAGE(window.get() == 0, contentOf(in("w.said")));
    const auto namesIn = [](const Result& hands) {
      std::multiset<std::string> names;
      for (const Result& hand : hands) names.insert(hand["name"].get<std::string>());
      return names;
    };
    const Result state = jsonOf(in("b.json"));
    CAPTURE(state.dump());
    CHECK(namesIn(state["other_hands"]) == std::multiset<std::string>{"Bert", "Bert, hand 2", "Carla"});
    CHECK(state["partial"]["restarts"] == 0);
    CHECK(state["partial"]["points"] > 0);
    const Result t = jsonOf(in("t.json")), c = jsonOf(in("c.json"));
    CHECK(namesIn(t["other_hands"]) == std::multiset<std::string>{"Ada", "Carla"});
    CHECK(namesIn(c["other_hands"]).contains("Ada"));
    CHECK(t["other_hands"][0]["position"].size() == 3);
    CHECK(serving.program.wait(SIGINT) == 0);
  }
}

TEST_CASE("a server killed during a stroke continues with its journal, and no edit is lost or applied twice") {
  if (!isBuilt()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make sphere -n 20000 -o " + in("m.ply"));
  const std::string serve = in("m.ply") + " --name clay --journal " + in("strokes");
  std::optional<Serving> serving(std::in_place, serve, folder / "said");
  RunningProgram hand("touch --join clay" + domain() +
                          " --backend cpu --realtime --duration 6 --edit push --penetration 4 --save " +
                          in("hand.ply") + " --json " + in("h.json"),
                      folder / "hand.said");
  CHECK(hand.waitFor([&] {
    std::error_code none;
    return std::filesystem::file_size(in("strokes"), none) > 5000 && !none;
  }));
  CHECK(serving->program.wait(SIGKILL) != 0);
  serving.emplace(serve + " --save " + in("end.ply") + " --json " + in("s.json"), folder / "said2");
  CHECK(contentOf(folder / "said2").find("continues with") != std::string::npos);
  hand.waitFor([&] { return hand.ended(); });
  const Result shared = jsonOf(in("h.json"))["shared"];
  CHECK(shared["delivered"] == true);
  CHECK(shared["same"] == true);
  CHECK(shared["resumed"] >= 2);
  CHECK(contentOf(folder / "hand.said").find("arrive again") != std::string::npos);
  CHECK(serving->program.wait(SIGINT) == 0);
  const Result served = jsonOf(in("s.json"));
  CHECK(served["states"] == shared["sent"]);
  CHECK(pointsOf(in("hand.ply")) == pointsOf(in("end.ply")));
  CHECK(pointsOf(in("end.ply")).size() > 20000 * 12);
  // Strokes of another model are refused.
  works("make sphere -n 2000 -o " + in("other.ply"));
  const Outcome other = palpate("serve " + in("other.ply") + " --name clay --journal " + in("strokes") + domain());
  CHECK(other.code == 1);
  CHECK(other.text.find("strokes of another model, of 20000 points") != std::string::npos);
}

}  // namespace palpate::sharing_test
