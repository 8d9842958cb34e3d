// Sessions with keys, through the program: holders join, others find nothing, and no message can be read on the wire.
// Not for a build without PALPATE_NETWORK.
#include <array>
#include <cstring>
#include <string>
#include <thread>

#include "engine/io/cloud_formats.hpp"
#include "tests/apps/serving.hpp"
#include "tests/says.hpp"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace palpate::security_test {

namespace {

// Captures the loopback traffic of one DDS domain during its lifetime.
class WireCapture {
 public:
  explicit WireCapture(unsigned domain)
      : firstPort_(7400 + 250 * domain), socket_(::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, htons(ETH_P_ALL))) {
    if (socket_ < 0) return;
    const int room = 64 << 20;
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof room);
    const timeval look{.tv_sec = 0, .tv_usec = 50'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &look, sizeof look);
    thread_ = std::jthread([this](const std::stop_token& stop) { listen(stop); });
  }
  ~WireCapture() {
    end();
    if (socket_ >= 0) ::close(socket_);
  }
  WireCapture(const WireCapture&) = delete;
  WireCapture& operator=(const WireCapture&) = delete;

  /// False if this user may not listen.
  bool isListening() const { return socket_ >= 0; }
  /// Ends the capture; returns all bytes in order.
  const std::string& end() {
    if (thread_.joinable()) {
      thread_.request_stop();
      thread_.join();
    }
    return heard_;
  }

 private:
  void listen(const std::stop_token& stop) {
    std::array<char, 1 << 16> frame;
    while (!stop.stop_requested()) {
      const ssize_t size = ::recv(socket_, frame.data(), frame.size(), 0);
      if (size > 0 && isOurs(frame, static_cast<std::size_t>(size)))
        heard_.append(frame.data(), static_cast<std::size_t>(size));
    }
  }
  // UDP of IPv4, to a port of the domain. Other tests use other domains meanwhile.
  bool isOurs(const std::array<char, 1 << 16>& frame, std::size_t size) const {
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(frame[i]); };
    constexpr std::size_t kIp = 14;
    if (size < kIp + 28 || at(12) != 0x08 || at(13) != 0 || at(kIp + 9) != IPPROTO_UDP) return false;
    const std::size_t udp = kIp + (at(kIp) & 0x0fU) * 4;
    if (size < udp + 8) return false;
    const unsigned port = at(udp + 2) * 256U + at(udp + 3);
    return port >= firstPort_ && port < firstPort_ + 250;
  }

  unsigned firstPort_;
  int socket_;
  std::string heard_;
  std::jthread thread_;  // destroyed first
};

bool isEncryptionBuilt(const ScratchFolder& folder) {
  if (!isBuilt()) return false;
  const Outcome keys = palpate("keys " + (folder / "try").string() + " --name a");
  if (keys.code == 0) return true;
  MESSAGE("skipped: this palpate was built without encryption: " << keys.text);
  return false;
}

/// Number of the cloud's points found in the captured bytes, by their positions as sent.
std::size_t placesIn(const std::string& heard, const PointCloud& cloud) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < cloud.size(); i += 97) {
    char place[sizeof(Vec3)];
    std::memcpy(place, &cloud.positions[i], sizeof place);
    found += heard.find(std::string(place, sizeof place)) != std::string::npos;
  }
  return found;
}

}  // namespace

TEST_CASE("holders of keys join, sculpt and have the same points; without these keys there is no session") {
  const ScratchFolder folder;
  if (!isEncryptionBuilt(folder)) return;
  const auto in = [&](const std::string& name) { return (folder / name).string(); };
  works("make bumpy-sphere -n 20000 --seed " + std::to_string(::getpid()) + " -o " + in("m.ply"));  // a unique cloud
  works("keys '" + in("the lab") + "' --name server");
  works("keys '" + in("the lab") + "' --name surgeon --days 2 --json " + in("keys.json"));
  works("keys " + in("other") + " --name surgeon");
  CHECK(jsonOf(in("keys.json"))["new_authority"] == false);
  checkEnds(1, "keys '" + in("the lab") + "' --name surgeon", {"exists already"});
  const std::string own = " --security '" + in("the lab") + "/surgeon'",
                    others = " --security " + in("other") + "/surgeon";
  WireCapture wire(ownDomain());
  Serving serving(in("m.ply") + " --name clay --save " + in("end.ply") + " --security '" + in("the lab") + "/server'",
                  folder / "said");
  CHECK(says(contentOf(folder / "said"), "encrypted, for holders of keys of 'the_lab' on this machine"));
  // Rejected clients search until their timeout.
  RunningProgram none("touch --join clay --backend cpu" + domain(), folder / "none.said"),
      wrong("touch --join clay --backend cpu" + domain() + others, folder / "wrong.said");
  works("touch --join clay --backend cpu --duration 0.1 --save " + in("joined.ply") + domain() + own);
  works("touch --join clay --backend cpu --duration 0.3 --edit push --penetration 4 --save " + in("hand.ply") +
        " --json " + in("hand.json") + domain() + own);
  const Outcome listed = palpate("doctor --network" + domain() + own);
  CHECK(says(listed.text, "clay: 20000 points of m.ply"));
  const Outcome hidden = palpate("doctor --network" + domain());
  CHECK(hidden.text.find("clay") == std::string::npos);
  CHECK(says(hidden.text, "There are programs with keys"));
  for (RunningProgram* outside : {&none, &wrong}) CHECK(outside->waitFor([&] { return outside->ended(); }));
  CHECK(none.wait(0) != 0);
  CHECK(wrong.wait(0) != 0);
  CHECK(says(contentOf(folder / "none.said"), "no session named 'clay' is served"));
  CHECK(says(contentOf(folder / "none.said"), "there are programs with keys, and this one has none"));
  CHECK(says(contentOf(folder / "wrong.said"), "no session named 'clay' is served"));
  CHECK(says(contentOf(folder / "wrong.said"), "are they of the authority of"));
  checkEnds(1, "serve " + in("m.ply") + " --name clay" + domain() + own, {"served already"});
  CHECK(serving.program.wait(SIGINT) == 0);
  const Result shared = jsonOf(in("hand.json"))["shared"];
  CHECK(shared["sent"] > 10);
  CHECK(shared["delivered"] == true);
  CHECK(shared["same"] == true);
  for (const char* name : {"m", "joined", "hand", "end"}) works("convert " + in(name) + ".ply " + in(name) + ".npy");
  CHECK(contentOf(in("joined.npy")) == contentOf(in("m.npy")));
  CHECK(contentOf(in("hand.npy")) == contentOf(in("end.npy")));
  CHECK(contentOf(in("end.npy")) != contentOf(in("m.npy")));

  if (!wire.isListening()) {
    MESSAGE("skipped: this user may not capture on the loopback, so that the encryption on the wire is not checked");
    return;
  }
  const PointCloud cloud = readCloud(in("m.ply")).cloud;
  const std::string& heard = wire.end();
  CHECK(heard.size() > 20'000 * sizeof(Vec3) * 2);
  CHECK(placesIn(heard, cloud) == 0);
  CHECK(heard.find("clay") == std::string::npos);
  CHECK(heard.find("m.ply") == std::string::npos);
  CHECK(heard.find("/points") == std::string::npos);
  // The same without keys: every listener can read all of it.
  WireCapture clear(ownDomain());
  Serving open(in("m.ply") + " --name clay", folder / "open.said");
  works("touch --join clay --backend cpu --duration 0.05" + domain());
  CHECK(open.program.wait(SIGINT) == 0);
  const std::string& all = clear.end();
  CHECK(placesIn(all, cloud) > 150);
  CHECK(all.find("/points") != std::string::npos);
}

TEST_CASE("unusable keys and invalid names are refused before anything is sent") {
  const ScratchFolder folder;
  if (!isEncryptionBuilt(folder)) return;
  const auto in = [&](const std::string& name) { return (folder / name).string(); };
  const auto refuses = [&](const std::string& arguments, int code, const std::string& words) {
    const Outcome outcome = palpate(arguments);
    CAPTURE(arguments);
    CHECK(outcome.code == code);
    CHECK(says(outcome.text, words));
  };
  works("make sphere -n 1000 -o " + in("m.ply"));
  works("keys " + in("lab") + " --name a");
  refuses("keys " + in("lab"), 2, "--name");
  refuses("keys " + in("lab") + " --name a/b", 2, "is not a valid holder's name");
  refuses("keys " + in("lab") + " --name b --days 0", 2, "--days");
  refuses("touch a.ply --security " + in("lab/a"), 2, "require --join");
  refuses("doctor --security " + in("lab/a"), 2, "require --network");
  std::filesystem::permissions(folder / "lab" / "a" / "key.pem", std::filesystem::perms::others_read,
                               std::filesystem::perm_options::add);
  for (const std::string& command :
       {"serve " + in("m.ply") + " --name x", std::string("touch --join x"), std::string("doctor --network"),
        "render --join x -o " + in("p.png"), "serve " + in("m.ply") + " --name x --ros x"}) {
    refuses(command + domain() + " --security " + in("lab/a"), 1, "key.pem: others than its owner can read or write");
    refuses(command + domain() + " --security " + in("lab"), 1, "name the folder of one holder");
  }
}

}  // namespace palpate::security_test
