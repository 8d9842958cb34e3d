#include "engine/render/drawn_cloud.hpp"

#include <bit>
#include <cmath>
#include <random>

#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/shared/brush.h"
#include "tests/labels.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::drawn_cloud_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

/// Acts as the touch side: writes entries into the ring and publishes them; keeps the expected cloud.
class Writer {
 public:
  Writer(Device& device, const PointCloud& cloud)
      : device_(device), log_(device, cloud.size(), 0), reader_(log_), cloud_(cloud) {
    ring_.resize(log_.capacity());
  }

  void write(std::uint32_t id) {
    const Vec3 normal = glm::normalize(Vec3(unit_(random_), unit_(random_), 1.5f));
    const PackedState entry{.position = Vec3(unit_(random_), unit_(random_), unit_(random_)),
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
  std::vector<PackedState> ring_;
  std::uint64_t head_ = 0;
  std::mt19937 random_{9};
  std::uniform_real_distribution<float> unit_{-1, 1};
};

/// Random edits of points: moved, recoloured, removed, restored, new, or without a slot in the drawn cloud.
class RandomStates {
 public:
  explicit RandomStates(std::uint32_t places) : places_(places) {}

  std::vector<PointState> take(std::size_t count) {
    std::vector<PointState> states(count);
    for (PointState& state : states) {
      const std::uint32_t number = random_() % (places_ + 2);
      const bool gone = random_() % 5 == 0;
      state = {.position = Vec3(unit_(random_), unit_(random_), unit_(random_)),
               .gone = gone,
               .number = number,
               .normal = glm::normalize(Vec3(unit_(random_), unit_(random_), 1.5f)),
               .color = static_cast<std::uint32_t>(random_()),
               .parent = number};
    }
    return states;
  }

 private:
  std::uint32_t places_;
  std::mt19937 random_{5};
  std::uniform_real_distribution<float> unit_{-1, 1};
};

class DrawnCloudFixture : public GpuFixture {
 protected:
  /// All data that a frame reads, bit by bit: an empty slot is NaN.
  std::vector<std::uint32_t> bits(const DrawnCloud& drawn) {
    std::vector<std::uint32_t> all;
    for (const Buffer* buffer : {&drawn.positions(), &drawn.normals(), &drawn.colors(), &drawn.shapes().clips}) {
      const auto words = download<std::uint32_t>(device, *buffer, buffer->bytes() / sizeof(std::uint32_t));
      all.insert(all.end(), words.begin(), words.end());
    }
    return all;
  }
  /// An empty submission; its ticket counts the earlier ones.
  Queue::Ticket ticketOfTouch() {
    CommandList nothing(device, device.latencyQueue(), "nothing");
    nothing.begin();
    nothing.end();
    const Queue::Ticket ticket = device.latencyQueue().submit(nothing);
    device.latencyQueue().wait(ticket);
    return ticket;
  }
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

TEST_CASE_FIXTURE(DrawnCloudFixture, "an empty log changes nothing") {
  const PointCloud cloud = strewnCloud(257);
  DrawnCloud drawn(device, cloud);
  Writer writer(device, cloud);
  CHECK(drawn.catchUp(writer.reader()) == 0);
  CHECK(same(drawn, cloud));
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "the drawn cloud follows the edit log, also when the ring wraps") {
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

TEST_CASE_FIXTURE(DrawnCloudFixture, "a full ring that wraps, with repeated entries of a point, is applied in order") {
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

TEST_CASE_FIXTURE(DrawnCloudFixture, "a hundred thousand log entries for three points are applied") {
  const PointCloud cloud = strewnCloud(50'000);
  DrawnCloud drawn(device, cloud);
  Writer writer(device, cloud);
  for (std::uint32_t i = 0; i < 100'003; ++i) writer.write(i % 3);
  writer.publish();
  CHECK(drawn.catchUp(writer.reader()) == 100'003);
  CHECK(same(drawn, writer.cloud()));
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "several ticks are applied at once, in order") {
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

TEST_CASE_FIXTURE(DrawnCloudFixture, "states from the host give the same drawn cloud as the log, bit by bit") {
  const PointCloud cloud = strewnCloud(1000);
  const DrawnOptions options{.spare = 100, .painted = true, .spacing = 0.1, .edited = true};
  DrawnCloud byLog(device, cloud, options), byHost(device, cloud, options);
  EditLog log(device, 200'000);
  EditLog::Reader reader(log);
  RandomStates states(byLog.count());
  std::uint64_t head = 0;
  CHECK(byHost.catchUp(std::span<const PointState>()) == 0);
  for (const std::size_t count : {1u, 255u, 256u, 257u, 65'535u, 65'536u, 65'537u, 131'072u, 150'001u}) {
    CAPTURE(count);
    const std::vector<PointState> batch = states.take(count);
    std::vector<PackedState> ring(log.capacity());
    for (const PointState& state : batch) ring[head++ % log.capacity()] = packedState(state);
    upload(device, log.entriesBuffer(), ring);
    log.publish(static_cast<std::uint32_t>(head));
    const auto before = bits(byLog);
    CHECK(byLog.catchUp(reader) == count);
    CHECK(byHost.catchUp(batch) == count);
    byLog.closeSurface();
    byHost.closeSurface();
    REQUIRE(bits(byHost) == bits(byLog));
    CHECK(bits(byHost) != before);
    CHECK(byHost.largestRadius() == byLog.largestRadius());
  }
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "the last of several states of a point counts, in whatever pieces they are sent") {
  const PointCloud cloud = strewnCloud(300);
  DrawnCloud drawn(device, cloud);
  PointCloud expected = cloud;
  std::vector<PointState> states(100'003);
  for (std::uint32_t i = 0; i < states.size(); ++i) {
    const std::uint32_t id = i < 50'000 ? 7 : i % 3;  // 7 only long before the end
    states[i] = {.position = Vec3(static_cast<float>(i)), .number = id, .normal = Vec3(0, 0, 1), .parent = id};
    expected.positions[id] = states[i].position;
    expected.normals[id] = states[i].normal;
  }
  CHECK(drawn.catchUp(states) == states.size());
  CHECK(same(drawn, expected));
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "the drawn cloud is built, updated and drawn without touch's queue") {
  const PointCloud cloud = strewnCloud(1000);
  EditLog log(device, cloud.size());
  EditLog::Reader reader(log);
  RandomStates states(1000);
  std::vector<PackedState> entries(100);
  std::ranges::transform(states.take(100), entries.begin(), packedState);
  upload(device, log.entriesBuffer(), entries);
  log.publish(100);
  const Queue::Ticket before = ticketOfTouch();
  DrawnCloud drawn(device, cloud, {.painted = true, .spacing = 0.1, .edited = true});
  CHECK(drawn.catchUp(reader) == 100);
  CHECK(drawn.catchUp(states.take(100)) == 100);
  drawn.closeSurface();
  Frame frame(device, 16, 16, 1);
  CommandList list(device, device.throughputQueue(), "test frame");
  list.begin();
  frame.record(list, drawn, Camera::fitting(cloud, 1), {});
  list.end();
  device.throughputQueue().run(list);
  CHECK(frame.readDiscs() > 0);
  CHECK(ticketOfTouch() == before + 1);
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "the drawn cloud follows points that are removed, restored, added and painted") {
  const PointCloud cloud = strewnCloud(300);
  DrawnCloud drawn(device, cloud, {.spare = 3, .painted = true});
  EditLog log(device, cloud.size());
  EditLog::Reader reader(log);
  const Vec3 place(1, 2, 3), normal(0, 0, 1);
  const auto entry = [&](std::uint32_t id, std::uint32_t color) {
    return PackedState{.position = place, .id = id, .normal = normal, .color = color, .parent = 0};
  };
  upload(device, log.entriesBuffer(),
         std::vector{entry(7 | PackedState::kGone, 1), entry(302, 0xff00ff00), entry(8 | PackedState::kGone, 0),
                     entry(8, 5), entry(303, 9)});
  log.publish(5);
  CHECK(drawn.catchUp(reader) == 5);
  const auto positions = download<Vec4>(device, drawn.positions(), drawn.count());
  const auto colors = download<std::uint32_t>(device, drawn.colors(), drawn.count());
  REQUIRE(positions.size() == 303);
  CHECK(std::isnan(positions[7].x));
  CHECK(Vec3(positions[8]) == place);
  CHECK(colors[8] == 5);
  CHECK(std::isnan(positions[301].x));  // an empty slot
  CHECK(Vec3(positions[302]) == place);
  CHECK(colors[302] == 0xff00ff00);
  CHECK(colors[0] == shared::kUnpainted);
}

TEST_CASE_FIXTURE(DrawnCloudFixture,
                  "a drawn cloud with all points moved copies a live cloud, in any order, or a frame") {
  for (const std::size_t count : {1, 255, 256, 257, 3000}) {
    CAPTURE(count);
    const PointCloud cloud = strewnCloud(count);
    PointCloud moved = cloud;
    for (Vec3& position : moved.positions) position = Vec3(position.y + 0.25f, -position.x, position.z);
    for (Vec3& normal : moved.normals) normal = Vec3(normal.y, -normal.x, normal.z);
    LiveCloud live(device, moved);
    SpatialHash(device, makeHashGrid(Vec3(-1), 0.1, count), live.slots()).build(live);
    const DrawnOptions options{.spacing = 0.1, .edited = true};
    std::vector<PointState> states;
    for (std::uint32_t k = 0; k < count; ++k)
      states.push_back({.position = moved.positions[k], .number = k, .normal = moved.normals[k], .parent = k});
    DrawnCloud fromGpu(device, cloud, options), fromHost(device, cloud, options), byEdits(device, cloud, options);
    fromGpu.place(live.front(), live.slots());
    fromHost.place(CloudFrame{.positions = moved.positions, .normals = moved.normals});
    byEdits.catchUp(states);
    for (DrawnCloud* drawn : {&fromGpu, &fromHost, &byEdits}) drawn->closeSurface();
    const auto positions = download<Vec4>(device, fromGpu.positions(), count);
    std::size_t misplaced = 0;
    for (std::uint32_t k = 0; k < count; ++k)
      misplaced += positions[k] != Vec4(moved.positions[k], std::bit_cast<float>(k));
    CHECK(misplaced == 0);
    CHECK(bits(fromGpu) == bits(byEdits));
    CHECK(bits(fromHost) == bits(byEdits));
  }
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "after a frame with small changes each disc is as if all were measured again") {
  PointCloud cloud = strewnCloud(3000);
  cloud.positions[2] = Vec3(-1.5f);  // two fixed points keep the grid unchanged
  cloud.positions[3] = Vec3(1.5f);
  const DrawnOptions options{.spacing = 0.1, .edited = true};
  PointCloud left;
  CloudFrame frame;
  for (std::uint32_t id = 0; id < cloud.size(); ++id) {
    if (id % 31 == 5) continue;  // removed
    const bool moves = id % 97 == 0, turns = id % 89 == 1;
    const Vec3 normal = cloud.normals[id];
    left.positions.push_back(cloud.positions[id] + (moves ? Vec3(0.4f, -0.35f, 0.5f) : Vec3(0)));
    left.normals.push_back(turns ? Vec3(normal.y, normal.z, normal.x) : normal);
    frame.ids.push_back(id);
  }
  frame.positions = left.positions;
  frame.normals = left.normals;
  DrawnCloud drawn(device, cloud, options), measured(device, left, options);
  const auto whole = bits(drawn);
  // The first frame measures all discs; the second is under test.
  drawn.place(CloudFrame{.positions = cloud.positions, .normals = cloud.normals});
  drawn.closeSurface();
  CHECK(bits(drawn) == whole);
  drawn.place(frame);
  drawn.closeSurface();
  const auto positions = download<Vec4>(device, drawn.positions(), drawn.count());
  const auto normals = download<Vec4>(device, drawn.normals(), drawn.count());
  const auto clips = download<std::uint32_t>(device, drawn.shapes().clips, drawn.count());
  const auto expectedNormals = download<Vec4>(device, measured.normals(), measured.count());
  const auto expectedClips = download<std::uint32_t>(device, measured.shapes().clips, measured.count());
  std::size_t wrong = 0, there = 0;
  for (std::size_t k = 0; k < frame.ids.size(); ++k) {
    const std::uint32_t id = frame.ids[k];
    wrong += positions[id] != Vec4(frame.positions[k], std::bit_cast<float>(id)) || normals[id] != expectedNormals[k] ||
             clips[id] != expectedClips[k];
  }
  for (const Vec4& position : positions) there += !std::isnan(position.x);
  CHECK(wrong == 0);
  CHECK(there == frame.ids.size());
  CHECK(drawn.largestRadius() > 0);
  // All points are restored at their old positions.
  drawn.place(CloudFrame{.positions = cloud.positions, .normals = cloud.normals});
  drawn.closeSurface();
  CHECK(bits(drawn) == whole);
}

TEST_CASE_FIXTURE(DrawnCloudFixture, "discs are measured again around the old and the new position of a moved point") {
  PointCloud cloud = strewnCloud(3000);
  cloud.positions[2] = Vec3(-1.5f);  // two fixed points keep the grid unchanged
  cloud.positions[3] = Vec3(1.5f);
  const DrawnOptions options{.spacing = 0.1, .edited = true};
  DrawnCloud drawn(device, cloud, options);
  const auto placed = [&](const PointCloud& at) {
    drawn.place(CloudFrame{.positions = at.positions, .normals = at.normals});
    drawn.closeSurface();
  };
  placed(cloud);
  for (const std::size_t id : {10, 500, 2999}) {
    CAPTURE(id);
    PointCloud moved = cloud;
    moved.positions[id] = -0.9f * moved.positions[id];
    placed(moved);
    CHECK(bits(drawn) == bits(DrawnCloud(device, moved, options)));
    placed(cloud);
  }
}

TEST_CASE_FIXTURE(DrawnCloudFixture,
                  "a point keeps its disc near the position of its measurement, and gets a new one further away") {
  const PointCloud cloud = strewnCloud(2000);
  const DrawnOptions options{.spacing = 0.1, .edited = true};
  DrawnCloud drawn(device, cloud, options);
  const auto placed = [&](float way) {
    CloudFrame frame{.positions = cloud.positions, .normals = cloud.normals};
    for (std::size_t id = 0; id < frame.size(); ++id)
      frame.positions[id] += way * Vec3(id % 2 == 0 ? 1 : -1, id % 3 == 0 ? 1 : -1, 0);
    drawn.place(frame);
    drawn.closeSurface();
    CHECK(download<Vec4>(device, drawn.positions(), drawn.count())[7] ==
          Vec4(frame.positions[7], std::bit_cast<float>(7u)));
    return download<Vec4>(device, drawn.normals(), drawn.count());
  };
  const auto differing = [](const std::vector<Vec4>& one, const std::vector<Vec4>& other) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < one.size(); ++i) count += one[i].w != other[i].w;
    return count;
  };
  const auto measured = placed(0);
  CHECK(differing(placed(0.001f), measured) == 0);
  CHECK(differing(placed(0.002f), measured) == 0);
  // The same in small steps: the total displacement counts.
  CHECK(differing(placed(0.003f), measured) == 0);
  CHECK(differing(placed(0.005f), measured) > cloud.size() / 10);  // the others have the usual size before and after
}

TEST_SUITE_END();

}  // namespace palpate::drawn_cloud_test
