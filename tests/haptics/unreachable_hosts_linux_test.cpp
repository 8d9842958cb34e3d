// Where a Haply device looks for its service: this program's own connect() sees every address.
#include <arpa/inet.h>
#include <dlfcn.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/devices/driver_survey.hpp"
#include "haptics/devices/haply_device.hpp"
#include "tests/error_of.hpp"
#include "tests/fake_devices/fake_haply.hpp"
#include "tests/says.hpp"

namespace palpate::unreachable_hosts_test {
namespace {

std::mutex guard;
std::vector<std::string> connected;

void note(const sockaddr* address) {
  std::string text(INET6_ADDRSTRLEN, '\0');
  if (address->sa_family == AF_INET)
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, text.data(), INET6_ADDRSTRLEN);
  else if (address->sa_family == AF_INET6)
    inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, text.data(), INET6_ADDRSTRLEN);
  else
    return;
  const std::scoped_lock lock(guard);
  connected.emplace_back(text.c_str());
}

}  // namespace
}  // namespace palpate::unreachable_hosts_test

extern "C" int connect(int socket, const sockaddr* address, socklen_t size) {
  static const auto next = reinterpret_cast<int (*)(int, const sockaddr*, socklen_t)>(dlsym(RTLD_NEXT, "connect"));
  palpate::unreachable_hosts_test::note(address);
  return next(socket, address, size);
}

namespace palpate::unreachable_hosts_test {

TEST_CASE("a Haply device is only looked for on this machine, whatever host its service's configuration names") {
  const FakeHaply service({});
  {
    const std::scoped_lock lock(guard);
    connected.clear();
  }
  { const HaplyDevice device({}); }
  CHECK(surveyHaply().problem.empty());
  const std::scoped_lock lock(guard);
  CHECK(connected.size() >= 3);  // states, events and the version
  CHECK(std::ranges::all_of(connected, [](const std::string& address) { return address == "127.0.0.1"; }));
}

TEST_CASE("a Haply service that no longer accepts connections is reported within seconds") {
  const int door = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{.sin_family = AF_INET, .sin_port = 0, .sin_addr = {htonl(INADDR_LOOPBACK)}, .sin_zero = {}};
  socklen_t size = sizeof(address);
  REQUIRE(bind(door, reinterpret_cast<const sockaddr*>(&address), size) == 0);
  REQUIRE(listen(door, 0) == 0);
  REQUIRE(getsockname(door, reinterpret_cast<sockaddr*>(&address), &size) == 0);
  std::vector<int> waiting;  // they fill the queue of the port
  for (int i = 0; i < 4; ++i) {
    waiting.push_back(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0));
    connect(waiting.back(), reinterpret_cast<const sockaddr*>(&address), size);
  }
  const ScratchFolder folder;
  const Variable config("PALPATE_HAPLY_CONFIG", (folder / "haply.json").string());
  std::ofstream(folder / "haply.json") << R"({"communication/websocket/port": )" << ntohs(address.sin_port) << "}";
  const Stopwatch since;
  CHECK(says(errorOf([] { const HaplyDevice device({}); }), "the Haply service does not answer (127.0.0.1:"));
  CHECK(since.elapsed_s() < 30);
  for (const int one : waiting) close(one);
  close(door);
}

}  // namespace palpate::unreachable_hosts_test
