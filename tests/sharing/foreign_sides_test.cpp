// ctest: waits
// Servers and clients that are not palpate's: their messages are refused with a reason, and cause neither growth nor an
// exit.
#include <doctest/doctest.h>

#include <functional>
#include <limits>

#include "engine/cloud/edited_cloud.hpp"
#include "haptics/sharing/messages.hpp"
#include "tests/error_of.hpp"
#include "tests/says.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate::foreign_sides_test {

using namespace sharing;

namespace {

/// Announces what the test sets, and answers the first requests with the blocks that the test sets.
class ForeignServer {
 public:
  explicit ForeignServer(const std::string& name, std::uint64_t points = 3000)
      : participant_(ownNetwork()),
        topics_(participant_),
        notices_(participant_, topics_.notices, reliableQos(true)),
        facts_(participant_, topics_.facts, reliableQos(true)),
        requests_(participant_, topics_.requests, reliableQos(false)) {
    set(notice.session, session);
    notice.version = kVersion;
    put(notice.name, name);
    put(notice.host, "a foreign machine");
    notice.points = points;
    notice.mm_per_unit = 1;
  }
  void announce() {
    notices_.write(notice);
    set(facts.session, session);
    facts.points = notice.points;
    facts_.write(facts);
  }

  /// Joins its own session and answers it block by block. Returns the outcome of joinCloud().
  std::string joined(const std::function<void(Block&, std::vector<Point>&)>& spoil, std::uint32_t most = 1000) {
    announce();
    std::string said;
    std::atomic<bool> ended = false;
    std::jthread client([&] {
      said = errorOf<NetworkError>([&] { joinCloud(notice.name, {.network = ownNetwork(), .timeout_s = 1}); });
      ended = true;
    });
    std::uint32_t given = 0;
    std::optional<Writer<Block>> blocks;
    while (!ended) {
      requests_.take([&](const Request& request) {
        CHECK(request.count <= kMaxRequested);
        if (!blocks) blocks.emplace(participant_, topics_.blocks, reliableQos(false, partitionOf(request.client)));
        for (std::uint32_t i = 0; i < request.count && given < most; ++i, ++given) {
          std::vector<Point> points(pointsIn(request.first + i, notice.points),
                                    Point{.position = {1, 2, 3}, .normal = {0, 0, 1}});
          Block block{};
          set(block.session, session);
          block.number = request.first + i;
          block.every = request.every;
          spoil(block, points);
          give(block.points, points);
          blocks->write(block);
        }
      });
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return said;
  }

  Notice notice{};
  Facts facts{.edge = 1};
  const Id session = freshId();

 private:
  Participant participant_;
  Topics topics_;
  Writer<Notice> notices_;
  Writer<Facts> facts_;
  Reader<Request> requests_;
};

void leave(Block&, std::vector<Point>&) {}

}  // namespace

TEST_CASE("a server of another version or with an invalid cloud is refused with the reason") {
  ForeignServer newer("newer");
  newer.notice.version = kVersion + 1;
  CHECK(says(newer.joined(leave), "another version"));
  ForeignServer unscaled("unscaled");
  unscaled.notice.mm_per_unit = std::numeric_limits<double>::quiet_NaN();
  CHECK(says(unscaled.joined(leave), "invalid cloud"));
  ForeignServer nowhere("nowhere");
  nowhere.notice.origin[1] = std::numeric_limits<double>::infinity();
  CHECK(says(nowhere.joined(leave), "invalid cloud"));
  ForeignServer endless("endless", std::uint64_t{1} << 62);
  CHECK(says(endless.joined(leave), "invalid cloud"));
}

TEST_CASE("invalid, missing and surplus points, and others than announced, are refused") {
  CHECK(says(ForeignServer("short").joined([](Block&, std::vector<Point>& points) { points.pop_back(); }),
             "44 points instead of 45"));
  CHECK(says(ForeignServer("long").joined([](Block&, std::vector<Point>& points) { points.resize(64); }),
             "64 points instead of"));
  CHECK(says(ForeignServer("holes").joined([](Block&, std::vector<Point>& points) {
    points[7].position[2] = std::numeric_limits<float>::quiet_NaN();
  }),
             "it has no position"));
  CHECK(says(ForeignServer("spikes").joined([](Block&, std::vector<Point>& points) { points[0].normal[0] = 1e20f; }),
             "no normal"));
  CHECK(says(ForeignServer("others").joined(leave), "not those that were announced"));
  // Blocks of other sessions and beyond the end are ignored.
  CHECK(says(ForeignServer("strange").joined([](Block& block, std::vector<Point>&) { block.number += 1'000'000; }),
             "nothing received"));
  CHECK(says(ForeignServer("mixed").joined([](Block& block, std::vector<Point>&) { block.session[3] ^= 1; }),
             "nothing received"));
}

TEST_CASE("a server that announces billions of points costs only the memory of the points received") {
  ForeignServer boaster("boaster", std::uint64_t{3} << 30);
  CHECK(says(boaster.joined(leave, 70), "of 3221225472 points"));
}

TEST_CASE("a server that ends during the transfer is reported with the points received so far") {
  CHECK(says(ForeignServer("halting", 90'000).joined(leave, 5), "after 225 of 90000 points"));
}

TEST_CASE("names with control characters or invalid UTF-8 are made printable") {
  ForeignServer server("bell\x07 \x1b[31m");
  CHECK(says(server.joined(leave), "bell? ?[31m"));
  // The same for invalid UTF-8, which JSON cannot hold, and for control characters.
  const auto shown = [](const char* text) { return printable(text); };
  CHECK(shown("Z\u00fcrich \u20ac \U0001F600") == "Z\u00fcrich \u20ac \U0001F600");
  CHECK(shown("\xff\xfe a\x80") == "?? a?");
  CHECK(shown("\xc2\x9b"
              "31m") == "??31m");
  CHECK(shown("\xc0\xaf \xe0\x80\xaf \xed\xa0\x80 \xf4\x90\x80\x80 \xf8") == "?? ??? ??? ???? ?");
  CHECK(shown("\xe2\x82") == "??");
  std::string full(199, 'x');
  full.append("\u20ac");
  CHECK(shown(full.c_str()).size() == 199);  // cut before a character, and not inside it
}

TEST_CASE("invalid requests are counted, and the server continues") {
  PointCloud cloud;
  cloud.positions.assign(5000, Vec3(1, 2, 3));
  cloud.normals.assign(5000, Vec3(0, 0, 1));
  Served served(cloud, "steady");
  {
    const Participant participant(ownNetwork());
    const Topics topics(participant);
    const Writer<Request> requests(participant, topics.requests, reliableQos(false));
    const Reader<Notice> notices(participant, topics.notices, reliableQos(true));
    std::optional<Notice> notice;
    while (!notice) notices.take([&](const Notice& one) { notice = one; });
    while (true) {
      dds_publication_matched_status_t status{};
      dds_get_publication_matched_status(requests, &status);
      if (status.current_count > 0) break;
    }
    for (const auto& [first, count] : std::vector<std::array<std::uint32_t, 2>>{{0, 0},
                                                                                {0, kMaxRequested + 1},
                                                                                {112, 1},
                                                                                {0, 113},
                                                                                {0xffffffff, 1},
                                                                                {1, 0xffffffff},
                                                                                {0xffffffff, 0xffffffff}}) {
      Request request{};
      std::memcpy(request.session, notice->session, sizeof request.session);
      request.first = first;
      request.count = count;
      requests.write(request);
    }
    Request foreign{};
    foreign.count = 1;
    requests.write(foreign);  // of another session
    dds_wait_for_acks(requests, DDS_SECS(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  CHECK(joinCloud("steady", {.network = ownNetwork()}).cloud.positions == cloud.positions);
  const ServedCounts counts = served.end();
  CHECK(counts.refused == 7);
  CHECK(counts.clients == 1);
}

}  // namespace palpate::foreign_sides_test
