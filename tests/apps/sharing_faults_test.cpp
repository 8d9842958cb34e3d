// Faults in shared sessions, through the program: hands and servers that are killed or hang, programs of other
// versions, names that two servers claim. Not for a build without PALPATE_NETWORK.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <future>

#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/version_watch.hpp"
#include "tests/apps/serving.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/labels.hpp"

namespace palpate::sharing_faults_test {

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

bool isLargerThan(const std::filesystem::path& file, std::uintmax_t bytes) {
  std::error_code none;
  const auto size = std::filesystem::file_size(file, none);
  return !none && size > bytes;
}

/// Announces a session with that name and version without serving it.
class Announcement {
 public:
  Announcement(const std::string& name, std::uint32_t version)
      : participant_(NetworkConfig{.domain = ownDomain()}),
        topics_(participant_),
        notices_(participant_, topics_.notices, sharing::reliableQos(true)) {
    sharing::Notice notice{};
    sharing::set(notice.session, sharing::freshId());
    notice.version = version;
    sharing::put(notice.name, name);
    sharing::put(notice.host, "elsewhere");
    notice.points = 1000;
    notice.mm_per_unit = 1;
    notices_.write(notice);
  }

 private:
  sharing::Participant participant_;
  sharing::Topics topics_;
  sharing::Writer<sharing::Notice> notices_;
};

}  // namespace

TEST_CASE("a hand killed during a stroke leaves whole pieces, and the others and the server continue") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make bumpy-sphere -n 20000 -o " + in("m.ply"));
  const std::string serve = in("m.ply") + " --name clay --journal " + in("strokes");
  std::optional<Serving> serving(std::in_place, serve + " --save " + in("end.ply") + " --json " + in("s.json"),
                                 folder / "said");
  const std::string joins = "touch --join clay" + domain() + " --backend cpu --realtime ";
  // Back and forth over the top, ever deeper, for longer than it lives.
  {
    std::ofstream path(in("path.csv"));
    path << "t_s,x,y,z\n0,-30,0,60\n";
    for (int i = 1; i < 100; ++i) path << 0.3 * i << "," << (i % 2 ? -25 : 25) << ",0," << 44 - 0.1 * i << "\n";
  }
  RunningProgram killed(joins + "--path " + in("path.csv") + " --edit push", folder / "killed.said");
  REQUIRE(killed.waitFor([&] { return isLargerThan(in("strokes"), 5000); }));
  RunningProgram other(
      joins + "--duration 3 --path builtin:slide --edit inflate --save " + in("other.ply") + " --json " + in("o.json"),
      folder / "other.said");
  REQUIRE(other.waitFor([&] { return has(contentOf(folder / "other.said"), "points of"); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  REQUIRE_FALSE(killed.ended());
  CHECK(killed.wait(SIGKILL) == SIGKILL);
  other.waitFor([&] { return other.ended(); });
  CAPTURE(contentOf(folder / "other.said"));
  const Result shared = jsonOf(in("o.json"))["shared"];
  CHECK(shared["delivered"] == true);
  CHECK(shared["sent"] > 20);
  CHECK(shared["received"] > 20);
  CHECK(shared["same"] == true);
  CHECK(serving->program.wait(SIGINT) == 0);
  const Result served = jsonOf(in("s.json"));
  CHECK(served["sculptors"] == 2);
  CHECK(served["duplicate_pieces"] == 0);
  CHECK(served["refused"] == 0);
  CHECK(served["states"].get<int>() > shared["sent"].get<int>() + 100);  // edits sent by the killed hand count
  CHECK(pointsOf(in("other.ply")) == pointsOf(in("end.ply")));
  // Each piece is complete in the journal, too: a server restarted from it has the same points.
  Serving again(serve + " --save " + in("again.ply"), folder / "again.said");
  CHECK(has(contentOf(folder / "again.said"),
            "continues with " + std::to_string(served["pieces"].get<int>()) + " pieces"));
  CHECK_FALSE(has(contentOf(folder / "again.said"), "incomplete piece"));
  CHECK(again.program.wait(SIGINT) == 0);
  CHECK(pointsOf(in("again.ply")) == pointsOf(in("end.ply")));
}

TEST_CASE("the force fades while a server hangs, and returns from outside; of a read-only model it stays" * kClock) {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make sphere -n 20000 -o " + in("m.ply"));
  Serving clay(in("m.ply") + " --name clay --mm-per-unit 1", folder / "clay.said");
  Serving still(in("m.ply") + " --name still --read-only --mm-per-unit 1", folder / "still.said");
  // Inside for six seconds, out, and in again.
  constexpr double top = 50;
  std::ofstream(in("path.csv")) << "t_s,x,y,z\n0,0,0," << top + 3 << "\n0.2,0,0," << top - 2 << "\n6.4,0,0," << top - 2
                                << "\n6.6,0,0," << top + 3 << "\n6.8,0,0," << top - 2 << "\n8.2,0,0," << top - 2
                                << "\n";
  const auto touches = [&](const std::string& name) {
    return "touch --join " + name + domain() + " --backend cpu --realtime --path " + in("path.csv") + " --trace " +
           in((name + ".csv").c_str()) + " --json " + in((name + ".json").c_str());
  };
  RunningProgram hand(touches("clay"), folder / "hand.said"), safe(touches("still"), folder / "safe.said");
  REQUIRE(hand.waitFor([&] { return has(contentOf(folder / "hand.said"), "points of"); }));
  REQUIRE(safe.waitFor([&] { return has(contentOf(folder / "safe.said"), "points of"); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  clay.program.send(SIGSTOP);
  still.program.send(SIGSTOP);
  CHECK(hand.waitFor([&] { return has(contentOf(folder / "hand.said"), "the force fades"); }));
  CHECK(hand.waitFor([&] { return has(contentOf(folder / "hand.said"), "no force until the next message"); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  clay.program.send(SIGCONT);
  still.program.send(SIGCONT);
  hand.waitFor([&] { return hand.ended(); });
  safe.waitFor([&] { return safe.ended(); });
  CAPTURE(contentOf(folder / "hand.said"));
  CHECK(
      has(contentOf(folder / "hand.said"), "the force returns; where it was gone, once the hand has left the surface"));
  const Result report = jsonOf(in("clay.json"));
  CHECK(report["safety"]["aged_ticks"] > 700);
  CHECK(report["shared"]["oldest_s"] > 2);
  CHECK(report["shared"]["force_share"] == 1);
  CHECK(report["shared"]["round_trip_ms"] > 0);
  CHECK(report["shared"]["lost_percent"] == 0);  // it answered pending requests late
  const std::vector<Row> rows = readTrace(in("clay.csv"));
  constexpr double kSurface_N = 0.06, kStiffness_N_per_mm = 0.8;  // of a tick; of the spring, which the hand moves
  double most_N = 0, steepest_N = 0, jump_N = 0, last_N = 0;
  bool wasGone = false, cameBack = false;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double force_N = glm::length(rows[i].force), before_N = glm::length(rows[i - 1].force);
    most_N = std::max(most_N, force_N);
    if (rows[i].contact && rows[i].t_s > 1 && rows[i].t_s < 6) {
      wasGone = wasGone || (force_N == 0 && before_N > 0);
      if (rows[i].t_s - rows[i - 1].t_s < 0.003) steepest_N = std::max(steepest_N, before_N - force_N);
    }
    if (wasGone && rows[i].t_s < 6) CHECK_MESSAGE(force_N == 0, rows[i].t_s);  // connected again, and still inside
    const double moved_mm = glm::distance(rows[i].hip, rows[i - 1].hip), ticks = 1e3 * (rows[i].t_s - rows[i - 1].t_s);
    if (rows[i].t_s > 6) jump_N = std::max(jump_N, (force_N - before_N - kStiffness_N_per_mm * moved_mm) / ticks);
    cameBack = cameBack || (rows[i].t_s > 7 && force_N > 0.9 * most_N);
    last_N = force_N;
  }
  CHECK(most_N > 1);
  CHECK(wasGone);
  CHECK(steepest_N < kSurface_N);  // it faded
  CHECK(jump_N < kSurface_N);
  CHECK(cameBack);
  CHECK(last_N > 0.9 * most_N);
  CHECK(jsonOf(in("still.json"))["safety"]["aged_ticks"] == 0);
  CHECK(has(contentOf(folder / "safe.said"), "served read-only; it is felt even while the network is interrupted"));
  CHECK_FALSE(has(contentOf(folder / "safe.said"), "no message from"));
  const std::vector<Row> felt = readTrace(in("still.csv"));
  for (const Row& row : felt)
    if (row.t_s > 1 && row.t_s < 6) REQUIRE(glm::length(row.force) > 0.9 * most_N);
}

TEST_CASE("a window reports the effect of a silent server on the force") {
  if (!hasDisplay()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make sphere -n 5000 -o " + in("m.ply"));
  Serving serving(in("m.ply") + " --name clay", folder / "said");
  std::ofstream(in("script.txt")) << "0.5 state " << in("begin.json") << "\n6 state " << in("end.json") << "\n6 quit\n";
  std::future<int> window = std::async(std::launch::async, [&] {
    return std::system(("XDG_STATE_HOME=" + in("home") + " xvfb-run -a " + program() + " view --join clay" + domain() +
                        " --backend cpu --realtime --size 320x240 --script " + in("script.txt") + " > " +
                        in("view.said") + " 2>&1")
                           .c_str());
  });
  CHECK(serving.program.waitFor([&] { return std::filesystem::exists(in("begin.json")); }));
  serving.program.wait(SIGKILL);
  window.get();
  CAPTURE(contentOf(folder / "view.said"));
  const Result begin = jsonOf(in("begin.json")), end = jsonOf(in("end.json"));
  CHECK(begin["shared"]["force_share"] == 1);
  CHECK(end["shared"]["force_share"] == 0);
  CHECK(end["shared"]["age_s"] > 2);
  CHECK(has(end["last_message"].get<std::string>(), "no force until the next message"));
}

namespace {

// The versions in the message about the previous version, in parentheses.
std::string olderAndThis() { return fmt::format("({}, and this is {})", sharing::kVersion - 1, sharing::kVersion); }

}  // namespace

TEST_CASE("incompatible versions are refused on both sides with a reason, and so is a duplicate name") {
  const ScratchFolder folder;
  works("make sphere -n 1000 -o " + (folder / "m.ply").string());
  Serving serving((folder / "m.ply").string() + " --name here", folder / "said");
  {
    // A client of the previous version: it has other topics, and nobody receives its messages.
    const sharing::Participant old(NetworkConfig{.domain = ownDomain()}, sharing::versionQos(sharing::kVersion - 1));
    CHECK(serving.program.waitFor(
        [&] { return has(contentOf(folder / "said"), "another version of palpate " + olderAndThis()); }));
  }
  const Announcement older("older", sharing::kVersion - 1), twin("twins", sharing::kVersion),
      other("twins", sharing::kVersion);
  const Outcome refused = palpate("touch --join older --backend cpu" + domain());
  CHECK(refused.code == 1);
  CHECK(has(refused.text, "is served by another version of palpate " + olderAndThis()));
  const std::string report = (folder / "doctor.json").string();
  const Outcome listed = palpate("doctor --network --json " + report + domain());
  const Result sessions = jsonOf(report)["network"];
  REQUIRE(sessions.size() == 4);
  for (const Result& session : sessions) {
    CAPTURE(session.dump());
    const bool isServed = session["name"].get<std::string>() == "here";
    CHECK(session["round_trip_ms"].is_null() != isServed);
    if (isServed) CHECK(session["lost_percent"] < 50);
    if (!session["compatible"].get<bool>()) CHECK(session["lost_percent"].is_null());
  }
  CHECK(has(listed.text, "older: 1000 points"));
  CHECK(has(listed.text, fmt::format("another version of palpate ({}), cannot be joined", sharing::kVersion - 1)));
  const Outcome both = palpate("touch --join twins --backend cpu" + domain());
  CHECK(both.code == 1);
  CHECK(has(both.text, "two sessions are named 'twins'"));
  const Outcome second = palpate("serve " + (folder / "m.ply").string() + " --name here" + domain());
  CHECK(second.code == 1);
  CHECK(has(second.text, "served already"));
  // Existing clients are not disturbed.
  works("touch --join here --backend cpu --duration 0.05" + domain());
  CHECK_FALSE(has(contentOf(folder / "said"), fmt::format("({}, and", sharing::kVersion)));
  CHECK(serving.program.wait(SIGINT) == 0);
}

}  // namespace palpate::sharing_faults_test
