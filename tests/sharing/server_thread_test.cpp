// ctest: waits
// A server on its own thread: observed while it serves, ended while it is observed.
#include "haptics/sharing/server_thread.hpp"

#include <doctest/doctest.h>

#include "engine/core/clock.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate::server_thread_test {

namespace {

CloudServer::Parts partsOf(const std::string& name) { return {.network = ownNetwork(), .name = name}; }

}  // namespace

TEST_CASE("several threads can query a server while clients join") {
  const PointCloud cloud = ring(20'000);
  ServerThread server(cloud, partsOf("looked at"));
  std::atomic<bool> end = false;
  std::atomic<std::uint64_t> wrong = 0, looks = 0;
  std::vector<std::jthread> lookers;
  for (int i = 0; i < 3; ++i)
    lookers.emplace_back([&] {
      while (!end) {
        wrong += server.points().size() != cloud.size();
        wrong += server.counts().refused;
        ++looks;
      }
    });
  for (int i = 0; i < 2; ++i) {
    const JoinedCloud joined = joinCloud("looked at", {.network = ownNetwork()});
    CHECK(joined.cloud.positions == cloud.positions);
  }
  end = true;
  lookers.clear();
  CHECK(wrong == 0);
  CHECK(looks > 5);
  CHECK(server.counts().clients == 2);
  CHECK(server.isServing());
}

TEST_CASE("a stopped server still reports its points and counts, and a second stop does no harm") {
  const PointCloud cloud = ring(100);
  ServerThread server(cloud, partsOf("ended"));
  std::jthread looker([&] {
    for (int i = 0; i < 20; ++i) server.counts();
  });
  server.stop();
  looker.join();
  server.stop();
  CHECK_FALSE(server.isServing());
  CHECK_NOTHROW(server.check());
  CHECK(server.points().size() == 100);
  CHECK(server.counts().clients == 0);
  CHECK_THROWS_AS(joinCloud("ended", {.network = ownNetwork(), .timeout_s = 0.2}), NetworkError);
}

TEST_CASE("a server stops promptly right after its start") {
  const PointCloud cloud = ring(10);
  for (int i = 0; i < 3; ++i) {
    ServerThread server(cloud, partsOf("short"));
    const Stopwatch since;
    server.stop();
    CHECK(since.elapsed_s() < 3);
  }
}

}  // namespace palpate::server_thread_test
