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
        wants_(participant_, topics_.wants, bestEffortQos()) {
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
  std::string joined(const std::function<void(Points&, std::vector<Point>&)>& spoil, std::uint32_t most = 1000) {
    announce();
    std::string said;
    std::atomic<bool> ended = false;
    std::jthread client([&] {
      said = errorOf<NetworkError>([&] { joinCloud(notice.name, {.network = ownNetwork(), .timeout_s = 1}); });
      ended = true;
    });
    std::uint32_t given = 0, epoch = 0;
    std::uint64_t block = 0, sent = 0;  // in this epoch
    std::optional<Writer<Points>> writer;
    while (!ended) {
      wants_.take([&](const Want& want) {
        if (want.epoch != epoch) {
          block = want.first;
          sent = 0;
        }
        epoch = want.epoch;
        if (!writer) writer.emplace(participant_, topics_.points, reliableQos(false, partitionOf(idOf(want.client))));
        for (; block < blocksOf(notice.points) && given < most && sent < want.taken + 256; ++given, ++block) {
          std::vector<Point> points(pointsIn(block, notice.points), Point{.position = {1, 2, 3}, .normal = {0, 0, 1}});
          Points sample{};
          set(sample.session, session);
          sample.epoch = epoch;
          sample.sample = ++sent;
          spoil(sample, points);
          give(sample.points, points);
          std::array part{BrickPart{.key = block, .checksum = sharing::checksumOf(points)}};
          give(sample.parts, part);
          writer->write(sample);
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
  Reader<Want> wants_;
};

void leave(Points&, std::vector<Point>&) {}

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
  CHECK(says(ForeignServer("short").joined([](Points&, std::vector<Point>& points) { points.pop_back(); }),
             "42 points instead of 43"));
  CHECK(says(ForeignServer("long").joined([](Points&, std::vector<Point>& points) { points.resize(64); }),
             "64 points instead of"));
  CHECK(says(ForeignServer("holes").joined([](Points&, std::vector<Point>& points) {
    points[7].position[2] = std::numeric_limits<float>::quiet_NaN();
  }),
             "it has no position"));
  CHECK(says(ForeignServer("spikes").joined([](Points&, std::vector<Point>& points) { points[0].normal[0] = 1e20f; }),
             "no normal"));
  CHECK(says(ForeignServer("others").joined(leave), "not those that were announced"));
  // Samples of other sessions are ignored, and those that do not follow are requested again.
  CHECK(says(ForeignServer("strange").joined([](Points& sample, std::vector<Point>&) { sample.sample += 1'000'000; }),
             "nothing received"));
  CHECK(says(ForeignServer("mixed").joined([](Points& block, std::vector<Point>&) { block.session[3] ^= 1; }),
             "nothing received"));
}

TEST_CASE("a server that announces billions of points costs only the memory of the points received") {
  ForeignServer boaster("boaster", std::uint64_t{3} << 30);
  CHECK(says(boaster.joined(leave, 70), "of 3221225472 points"));
}

TEST_CASE("a server that ends during the transfer is reported with the points received so far") {
  CHECK(says(ForeignServer("halting", 90'000).joined(leave, 5), "after 215 of 90000 points"));
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
    const Writer<Want> wants(participant, topics.wants, bestEffortQos());
    const Reader<Notice> notices(participant, topics.notices, reliableQos(true));
    std::optional<Notice> notice;
    while (!notice) notices.take([&](const Notice& one) { notice = one; });
    while (true) {
      dds_publication_matched_status_t status{};
      dds_get_publication_matched_status(wants, &status);
      if (status.current_count > 0) break;
    }
    palpate_sharing_Ball endless{.center = {0, 0, 0}, .radius = std::numeric_limits<double>::infinity()};
    struct Asked {
      std::uint32_t epoch, every, first, balls;
    };
    for (const auto& [epoch, every, first, balls] : std::vector<Asked>{{0, 1, 0, 0},
                                                                       {0, 0, 0, 0},
                                                                       {1, 1, 118, 0},
                                                                       {1, 1, 0xffffffff, 0},
                                                                       {1, 5000, 2, 0},
                                                                       {1, 0xffffffff, 2, 0},
                                                                       {1, 0, 0, 1}}) {
      Want want{};
      std::memcpy(want.session, notice->session, sizeof want.session);
      want.number = 1;
      want.epoch = epoch;
      want.every = every;
      want.first = first;
      give(want.balls, std::span(&endless, balls));
      wants.write(want);
    }
    Want foreign{};
    foreign.epoch = 1;
    wants.write(foreign);  // of another session
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  CHECK(joinCloud("steady", {.network = ownNetwork()}).cloud.positions == cloud.positions);
  const ServedCounts counts = served.end();
  CHECK(counts.refused == 7);
  CHECK(counts.clients == 1);
}

}  // namespace palpate::foreign_sides_test
