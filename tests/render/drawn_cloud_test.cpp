#include "engine/render/drawn_cloud.hpp"

#include <bit>
#include <cmath>
#include <random>

#include "engine/gpu/transfer.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate {

namespace {

/// Plays the touch side: writes entries into the ring and publishes them; keeps what the cloud should be.
class Writer {
 public:
  Writer(Device& device, const PointCloud& cloud)
      : device_(device), log_(device, cloud.size(), 0), reader_(log_), cloud_(cloud) {
    ring_.resize(log_.capacity());
  }

  void write(std::uint32_t id) {
    const Vec3 normal = glm::normalize(Vec3(unit_(random_), unit_(random_), 1.5f));
    const shared::EditEntry entry{.position = Vec3(unit_(random_), unit_(random_), unit_(random_)),
                                  .id = id,
                                  .normal = normal,
                                  .color = 0,
                                  .parent = id};
    ring_[head_++ % log_.capacity()] = entry;
    cloud_.positions[id] = entry.position;
    cloud_.normals[id] = entry.normal;
  }
  void publish() {
    PALPATE_CHECK_LE(head_ - reader_.unread().end, log_.room());
    upload(device_, log_.entriesBuffer(), ring_);
    log_.publish(static_cast<std::uint32_t>(head_));
  }

  const EditLog& log() const { return log_; }
  EditLog::Reader& reader() { return reader_; }
  const PointCloud& cloud() const { return cloud_; }
  std::uint64_t head() const { return head_; }

 private:
  Device& device_;
  EditLog log_;
  EditLog::Reader reader_;
  PointCloud cloud_;
  std::vector<shared::EditEntry> ring_;
  std::uint64_t head_ = 0;
  std::mt19937 random_{9};
  std::uniform_real_distribution<float> unit_{-1, 1};
};

class DrawnCloudFixture : public GpuFixture {
 protected:
  bool same(const DrawnCloud& drawn, const PointCloud& cloud) {
    const auto positions = download<Vec4>(device, drawn.positions(), drawn.count());
    const auto normals = download<Vec4>(device, drawn.normals(), drawn.count());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (positions[i] != Vec4(cloud.positions[i], std::bit_cast<float>(static_cast<std::uint32_t>(i))) ||
          normals[i] != Vec4(cloud.normals[i], 0))
        return false;
    return true;
  }
};

}  // namespace

TEST_CASE_FIXTURE(DrawnCloudFixture, "nothing in the log changes nothing") {
  const PointCloud cloud = strewnCloud(257);
  DrawnCloud drawn(device, cloud);
  Writer writer(device, cloud);
  CHECK(drawn.catchUp(writer.reader()) == 0);
  CHECK(same(drawn, cloud));
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "the drawn cloud follows the log, round and round the ring") {
  const PointCloud cloud = strewnCloud(300);
  DrawnCloud drawn(device, cloud);
  Writer writer(device, cloud);
  std::mt19937 random(3);
  while (writer.head() < 4 * writer.log().capacity()) {
    const std::size_t entries = random() % 500;
    for (std::size_t i = 0; i < entries; ++i) writer.write(static_cast<std::uint32_t>(random() % cloud.size()));
    writer.publish();
    CHECK(drawn.catchUp(writer.reader()) == entries);
    CHECK(writer.reader().unread().size() == 0);
    REQUIRE(same(drawn, writer.cloud()));
  }
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "a full ring, over its end, where one point is named again and again") {
  const PointCloud cloud = strewnCloud(300);
  DrawnCloud drawn(device, cloud);
  Writer writer(device, cloud);
  for (int i = 0; i < 777; ++i) writer.write(5);
  writer.publish();
  CHECK(drawn.catchUp(writer.reader()) == 777);
  CHECK(same(drawn, writer.cloud()));
  for (std::uint64_t i = 0; i < writer.log().capacity(); ++i) writer.write(i % 7 == 0 ? 5 : 299);
  writer.publish();
  CHECK(drawn.catchUp(writer.reader()) == writer.log().capacity());
  CHECK(same(drawn, writer.cloud()));
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "a hundred thousand entries for three points") {
  const PointCloud cloud = strewnCloud(50'000);
  DrawnCloud drawn(device, cloud);
  Writer writer(device, cloud);
  for (std::uint32_t i = 0; i < 100'003; ++i) writer.write(i % 3);
  writer.publish();
  CHECK(drawn.catchUp(writer.reader()) == 100'003);
  CHECK(same(drawn, writer.cloud()));
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "several ticks are taken at once, in order") {
  const PointCloud cloud = strewnCloud(1000);
  DrawnCloud drawn(device, cloud);
  Writer writer(device, cloud);
  for (int tick = 0; tick < 5; ++tick) {
    for (std::uint32_t id = 100; id < 300; ++id) writer.write(id);
    writer.publish();
  }
  CHECK(drawn.catchUp(writer.reader()) == 1000);
  CHECK(same(drawn, writer.cloud()));
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "points go, come back, come new, and are painted") {
  const PointCloud cloud = strewnCloud(300);
  DrawnCloud drawn(device, cloud, {.spare = 3, .painted = true});
  EditLog log(device, cloud.size());
  EditLog::Reader reader(log);
  const Vec3 place(1, 2, 3), normal(0, 0, 1);
  const auto entry = [&](std::uint32_t id, std::uint32_t color) {
    return shared::EditEntry{.position = place, .id = id, .normal = normal, .color = color, .parent = 0};
  };
  upload(device, log.entriesBuffer(),
         std::vector{entry(7 | shared::kPointGone, 1), entry(302, 0xff00ff00), entry(8 | shared::kPointGone, 0),
                     entry(8, 5), entry(303, 9)});
  log.publish(5);
  CHECK(drawn.catchUp(reader) == 5);
  const auto positions = download<Vec4>(device, drawn.positions(), drawn.count());
  const auto colors = download<std::uint32_t>(device, drawn.colors(), drawn.count());
  REQUIRE(positions.size() == 303);
  CHECK(std::isnan(positions[7].x));
  CHECK(Vec3(positions[8]) == place);
  CHECK(colors[8] == 5);
  CHECK(std::isnan(positions[301].x));  // nobody has come there
  CHECK(Vec3(positions[302]) == place);
  CHECK(colors[302] == 0xff00ff00);
  CHECK(colors[0] == 0xffffffff);
}

}  // namespace palpate
