// A program with another DDS implementation (eProsima Fast DDS, with Fast CDR), like those of rmw_fastrtps: it
// identifies ROS's types by name and shares no code with palpate. On this machine's loopback:
//   fastdds_peer hear DOMAIN NAME SECONDS   a line of JSON for each pose, proxy, wrench and cloud of that name
//   fastdds_peer send DOMAIN TOPIC SECONDS  a PointCloud2 of a square, ten times a second
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;
using eprosima::fastrtps::rtps::SerializedPayload_t;

struct Header {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::string frame_id;
};
struct PoseStamped {
  static constexpr const char* kName = "geometry_msgs::msg::dds_::PoseStamped_";
  Header header;
  std::array<double, 7> pose{};  // position, orientation
};
struct WrenchStamped {
  static constexpr const char* kName = "geometry_msgs::msg::dds_::WrenchStamped_";
  Header header;
  std::array<double, 6> wrench{};  // force, torque
};
struct PointField {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;
  std::uint32_t count = 0;
};
struct PointCloud2 {
  static constexpr const char* kName = "sensor_msgs::msg::dds_::PointCloud2_";
  Header header;
  std::uint32_t height = 0, width = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0, row_step = 0;
  std::vector<std::uint8_t> data;
  bool is_dense = true;
};

// One list of fields for reading and writing: `each` reads or writes a field.
template <class Each>
void visit(Header& header, Each&& each) {
  each(header.sec), each(header.nanosec), each(header.frame_id);
}
template <class Each>
void visit(PoseStamped& message, Each&& each) {
  visit(message.header, each);
  for (double& number : message.pose) each(number);
}
template <class Each>
void visit(WrenchStamped& message, Each&& each) {
  visit(message.header, each);
  for (double& number : message.wrench) each(number);
}
template <class Each>
void visit(PointCloud2& cloud, Each&& each) {
  visit(cloud.header, each);
  each(cloud.height), each(cloud.width);
  auto count = static_cast<std::uint32_t>(cloud.fields.size());
  each(count);
  if (count > 100) throw std::runtime_error("too many fields");
  cloud.fields.resize(count);
  for (PointField& field : cloud.fields) each(field.name), each(field.offset), each(field.datatype), each(field.count);
  each(cloud.is_bigendian), each(cloud.point_step), each(cloud.row_step), each(cloud.data), each(cloud.is_dense);
}

template <class T>
class TypeOf : public TopicDataType {
 public:
  TypeOf() {
    setName(T::kName);
    m_typeSize = 1 << 16;  // initial size, it grows
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    payload->encapsulation = CDR_LE;
    cdr.serialize_encapsulation();
    visit(*static_cast<T*>(data), [&](auto& field) { cdr << field; });
    payload->length = static_cast<std::uint32_t>(cdr.getSerializedDataLength());
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->length);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    visit(*static_cast<T*>(data), [&](auto& field) { cdr >> field; });
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] {
      std::uint32_t most = 64;  // of numbers and their alignment
      visit(*static_cast<T*>(data), [&](auto& field) {
        if constexpr (requires { field.size(); })
          most += static_cast<std::uint32_t>(field.size()) + 16;
        else
          most += 16;
      });
      return most;
    };
  }
  void* createData() override { return new T; }
  void deleteData(void* data) override { delete static_cast<T*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

std::mutex printing;

std::string headOf(const char* topic, const Header& header) {
  return "{\"topic\": \"" + std::string(topic) + "\", \"sec\": " + std::to_string(header.sec) +
         ", \"nanosec\": " + std::to_string(header.nanosec) + ", \"frame\": \"" + header.frame_id + "\"";
}
template <class Numbers>
std::string listOf(const Numbers& numbers) {
  std::string text = "[";
  for (const double number : numbers) {
    char digits[40];
    std::snprintf(digits, sizeof digits, "%s%.17g", text.size() > 1 ? ", " : "", number);
    text += digits;
  }
  return text + "]";
}
std::string inWords(const char* topic, const PoseStamped& message) {
  return headOf(topic, message.header) + ", \"numbers\": " + listOf(message.pose) + "}";
}
std::string inWords(const char* topic, const WrenchStamped& message) {
  return headOf(topic, message.header) + ", \"numbers\": " + listOf(message.wrench) + "}";
}
std::string inWords(const char* topic, const PointCloud2& cloud) {
  std::string fields;
  for (const PointField& field : cloud.fields)
    fields += (fields.empty() ? "\"" : ", \"") + field.name + " " + std::to_string(field.offset) + " " +
              std::to_string(field.datatype) + " " + std::to_string(field.count) + "\"";
  std::vector<double> places;
  for (std::size_t i = 0; cloud.point_step >= 12 && (i + 1) * cloud.point_step <= cloud.data.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      float place = 0;
      std::memcpy(&place, cloud.data.data() + i * cloud.point_step + 4 * k, 4);
      places.push_back(place);
    }
  return headOf(topic, cloud.header) + ", \"width\": " + std::to_string(cloud.width) +
         ", \"height\": " + std::to_string(cloud.height) + ", \"fields\": [" + fields +
         "], \"numbers\": " + listOf(places) + "}";
}

// Only the loopback, with peers addressed by their ports: like ROS programs with LOCALHOST discovery.
DomainParticipant* participantOf(std::uint32_t domain) {
  DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
  auto loopback = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  loopback->interfaceWhiteList.emplace_back("127.0.0.1");
  loopback->maxInitialPeersRange = 41;
  loopback->sendBufferSize = loopback->receiveBufferSize = 4 << 20;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(loopback);
  eprosima::fastrtps::rtps::Locator_t here;
  eprosima::fastrtps::rtps::IPLocator::setIPv4(here, 127, 0, 0, 1);
  qos.wire_protocol().builtin.initialPeersList.push_back(here);
  auto* const participant = DomainParticipantFactory::get_instance()->create_participant(domain, qos);
  if (participant == nullptr) throw std::runtime_error("cannot create a DDS participant");
  return participant;
}

template <class T>
Topic* topicOf(DomainParticipant* participant, const std::string& name) {
  const TypeSupport type(new TypeOf<T>);
  type.register_type(participant);
  return participant->create_topic(name, T::kName, TOPIC_QOS_DEFAULT);
}

template <class T>
class Printing : public DataReaderListener {
 public:
  Printing(DomainParticipant* participant, Subscriber* subscriber, const std::string& name, const char* label,
           bool isLatched)
      : label_(label) {
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = isLatched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
    qos.history().kind = KEEP_ALL_HISTORY_QOS;
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    subscriber->create_datareader(topicOf<T>(participant, "rt/" + name + "/" + label), qos, this);
  }
  void on_data_available(DataReader* reader) override {
    T message;
    SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const std::string line = inWords(label_, message);
      const std::scoped_lock hold(printing);
      std::puts(line.c_str());
      std::fflush(stdout);
    }
  }

 private:
  const char* label_;
};

void hear(DomainParticipant* participant, const std::string& name, double seconds) {
  Subscriber* const subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  const auto pose = std::make_unique<Printing<PoseStamped>>(participant, subscriber, name, "pose", false);
  const auto proxy = std::make_unique<Printing<PoseStamped>>(participant, subscriber, name, "proxy", false);
  const auto wrench = std::make_unique<Printing<WrenchStamped>>(participant, subscriber, name, "wrench", false);
  const auto cloud = std::make_unique<Printing<PointCloud2>>(participant, subscriber, name, "cloud", true);
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  participant->delete_contained_entities();
}

// 41 x 31 points 5 mm apart, on z = 2 + x / 4.
PointCloud2 square() {
  PointCloud2 cloud{.header = {.sec = 1, .nanosec = 2, .frame_id = "lab"},
                    .height = 31,
                    .width = 41,
                    .point_step = 16,
                    .row_step = 656};
  for (const char* name : {"x", "y", "z"})
    cloud.fields.push_back(
        {.name = name, .offset = static_cast<std::uint32_t>(4 * cloud.fields.size()), .datatype = 7, .count = 1});
  cloud.data.resize(31 * 656);
  for (std::size_t i = 0; i < 31 * 41; ++i) {
    const float x = 0.005f * static_cast<float>(i % 41), y = 0.005f * static_cast<float>(i / 41);
    const float place[]{x, y, 2 + x / 4};
    std::memcpy(cloud.data.data() + 16 * i, place, sizeof place);
  }
  return cloud;
}

void send(DomainParticipant* participant, const std::string& topic, double seconds) {
  Publisher* const publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
  DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.publish_mode().kind = ASYNCHRONOUS_PUBLISH_MODE;
  DataWriter* const writer = publisher->create_datawriter(topicOf<PointCloud2>(participant, "rt/" + topic), qos);
  PointCloud2 cloud = square();
  for (const auto begin = std::chrono::steady_clock::now();
       std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(seconds);) {
    writer->write(&cloud);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  participant->delete_contained_entities();
}

}  // namespace

int main(int count, char** words) {
  if (count != 5) return std::fputs("fastdds_peer hear|send DOMAIN NAME SECONDS\n", stderr), 2;
  try {
    DomainParticipant* const participant = participantOf(static_cast<std::uint32_t>(std::atoi(words[2])));
    (std::string(words[1]) == "hear" ? hear : send)(participant, words[3], std::atof(words[4]));
    DomainParticipantFactory::get_instance()->delete_participant(participant);
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "fastdds_peer: %s\n", error.what()), 1;
  }
  return 0;
}
