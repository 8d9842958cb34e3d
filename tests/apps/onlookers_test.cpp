// Cameras of the participants of a shared session, through the program.
#include <chrono>
#include <fstream>
#include <functional>
#include <future>
#include <thread>

#include "engine/core/clock.hpp"
#include "haptics/sharing/presence.hpp"
#include "haptics/sharing/ros_messages.hpp"
#include "haptics/sharing/shared_cloud.hpp"
#include "tests/apps/running_program.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/own_domain.hpp"
#include "tests/sharing/ros_discovery.hpp"

namespace palpate::onlookers_test {

namespace {

// A domain that no other test uses at the same time.
NetworkConfig network() { return {.domain = ownDomain()}; }
std::string domain() { return " --domain " + std::to_string(network().domain); }

bool isThere(const std::filesystem::path& file) {
  std::error_code none;
  return std::filesystem::file_size(file, none) > 0 && !none;
}

/// The window, until its script quits or it is ended.
class Window {
 public:
  Window(const std::string& arguments, const std::string& script, const ScratchFolder& folder, const std::string& name)
      : said_((folder / (name + ".said")).string()) {
    std::ofstream(folder / (name + ".txt")) << inFolder(script, folder.path());
    command_ = fmt::format(
        "XDG_STATE_HOME={0} timeout 300 xvfb-run -a {1} view {2}{3} --backend cpu --realtime --size 480x360 --script "
        "{0}.txt > {4} 2>&1",
        (folder / name).string(), program(), arguments, domain(), said_);
    running_ = std::async(std::launch::async, [this] { return std::system(command_.c_str()); });
  }
  bool waitFor(const std::function<bool()>& sign) {
    for (const Stopwatch since; since.elapsed_s() < 120; std::this_thread::sleep_for(std::chrono::milliseconds(5))) {
      if (sign()) return true;
      if (running_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) break;
    }
    return sign();
  }
  int end() { return running_.get(); }
  std::string said() const { return contentOf(said_); }

 private:
  std::string said_, command_;
  std::future<int> running_;
};

/// Differing pixels in the middle of the picture, which has neither panels nor messages.
std::size_t differing(const Picture& a, const Picture& b) {
  REQUIRE(a.rgb.size() == b.rgb.size());
  std::size_t others = 0;
  for (int y = 40; y < a.height * 3 / 4; ++y)
    for (int x = a.width / 3; x < a.width - 10; ++x) {
      const auto before = a.at(x, y), after = b.at(x, y);
      others += std::abs(before[0] - after[0]) + std::abs(before[1] - after[1]) + std::abs(before[2] - after[2]) > 60;
    }
  return others;
}

}  // namespace

TEST_CASE("a window shows the others' cameras, shows them its own, publishes it to ROS, and can hide it") {
  if (!hasDisplay()) return;
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  works("make sphere -n 8000 --center 1000,0,0 -o " + in("m.ply"));
  RunningProgram serving("serve " + in("m.ply") + " --mm-per-unit 2 --name seen --read-only" + domain(),
                         folder / "said");
  REQUIRE(serving.waitFor([&] { return contentOf(folder / "said").find("serving") != std::string::npos; }));
  const JoinedCloud joined = joinCloud("seen", {.network = network()});
  const auto cameras = sharePresence(joined.session, "onlooker", joined.cloud);
  const sharing::Participant participant = sharing::rosParticipant(network());
  const sharing::RosType type = sharing::rosTypeOf<sharing::RosPoseStamped>();
  const sharing::Topic<sharing::RosPoseStamped> topic(participant, type.descriptor, "rt/lab/camera");
  const sharing::Reader<sharing::RosPoseStamped> poses(participant, topic,
                                                       sharing::rosQos(sharing::RosDelivery::reliable, type));
  {
    Window window("--join seen --hand-name Ada --ros lab",
                  "0.5 key Tab\n1 screenshot %/a.png\n1 state %/a.json\n1 await %/go\n2 screenshot %/b.png\n2 state "
                  "%/b.json\n2.1 "
                  "quit\n",
                  folder, "ada");
    REQUIRE_MESSAGE(window.waitFor([&] { return isThere(in("a.json")) && !cameras->cameras().empty(); }),
                    window.said());
    const SeenCamera seen = cameras->cameras().at(0);
    const Result camera = jsonOf(in("a.json"))["camera"];
    CHECK(jsonOf(in("a.json"))["other_cameras"].empty());
    CHECK(seen.name == "Ada");
    CHECK(seen.place.aspect == near(480.0 / 360, 1e-6));
    CHECK(seen.place.fovY_rad == near(glm::radians(45.0), 1e-6));
    // Its eye is relative to the cloud's origin, and the target is along its third axis.
    const auto vector = [](const Result& v) { return DVec3(v[0], v[1], v[2]); };
    const DVec3 eye = vector(camera["eye"]) + joined.cloud.origin,
                target = vector(camera["target"]) + joined.cloud.origin;
    CHECK(glm::distance(seen.place.position, eye) < 1e-6);
    CHECK(glm::distance(seen.place.turn * DVec3(0, 0, 1), glm::normalize(target - eye)) < 1e-5);
    CHECK(glm::dot(seen.place.turn * DVec3(0, 1, 0), vector(camera["up"])) < -0.5);  // image y is down
    int heard = 0;
    CHECK(within(30, [&] {
      poses.take([&](const sharing::RosPoseStamped& pose) {
        ++heard;
        CHECK(glm::distance(DVec3(pose.pose.position.x, pose.pose.position.y, pose.pose.position.z), eye * 2e-3) <
              1e-6);
        CHECK(std::abs(pose.pose.orientation.w) == within(std::abs(seen.place.turn.w), 1e-4));
      });
      return heard > 0;
    }));
    // An onlooker of the model, in view of the window's camera.
    const DVec3 middle = joined.cloud.origin + boundsOf(joined.cloud).center();
    cameras->show(
        CameraPlace{.position = middle + 0.4 * (eye - middle), .turn = seen.place.turn, .fovY_rad = 1, .aspect = 2});
    std::ofstream(in("go")) << "now";
    REQUIRE_MESSAGE(window.waitFor([&] { return isThere(in("b.json")); }), window.said());
    const Result others = jsonOf(in("b.json"))["other_cameras"];
    CAPTURE(others.dump());
    REQUIRE(others.size() == 1);
    CHECK(others[0]["name"] == "onlooker");
    CHECK(others[0]["aspect"] == 2);
    CHECK(others[0]["position"][0].get<double>() == within((middle + 0.4 * (eye - middle)).x, 1e-4));
    CHECK(window.end() == 0);
    CHECK(differing(Picture(in("a.png")), Picture(in("b.png"))) > 100);
  }
  works("touch --join seen --backend cpu --realtime --duration 1.5" + domain() + " --json " + in("t.json"));
  CHECK(jsonOf(in("t.json"))["cameras"] == 1);
  CHECK(within(30, [&] { return cameras->cameras().empty(); }));
  {
    Window hidden("--join seen --hand-name Bert --hide-camera", "0.5 state %/h.json\n2.5 state %/i.json\n2.5 quit\n",
                  folder, "bert");
    std::size_t most = 0;
    REQUIRE_MESSAGE(hidden.waitFor([&] {
      most = std::max(most, cameras->cameras().size());
      return isThere(in("i.json"));
    }),
                    hidden.said());
    CHECK(most == 0);
    CHECK(jsonOf(in("i.json"))["other_cameras"].size() == 1);  // it still sees others
    CHECK(hidden.end() == 0);
  }
  CHECK(serving.wait(SIGINT) == 0);
}

TEST_CASE("--hide-camera requires --join") {
  const Outcome outcome = palpate("view a.ply --hide-camera");
  CHECK(outcome.code == 2);
  CHECK(outcome.text.find("--hide-camera: requires --join") != std::string::npos);
}

}  // namespace palpate::onlookers_test
