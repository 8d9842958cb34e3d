// What ROS 2 programs see of palpate on the wire, as rmw_cyclonedds writes it: names of topics and types, and in the
// user data of readers, writers and participants the hash of the type and the enclave.
#pragma once

#include <string>

#include "haptics/sharing/dds.hpp"
#include "haptics/sharing/ros.h"

namespace palpate::sharing {

using RosHeader = std_msgs_msg_dds__Header_;
using RosPoint = geometry_msgs_msg_dds__Point_;
using RosPoseStamped = geometry_msgs_msg_dds__PoseStamped_;
using RosWrenchStamped = geometry_msgs_msg_dds__WrenchStamped_;
using RosTFMessage = tf2_msgs_msg_dds__TFMessage_;
using RosPointField = sensor_msgs_msg_dds__PointField_;
using RosPointCloud2 = sensor_msgs_msg_dds__PointCloud2_;
using RosImage = sensor_msgs_msg_dds__Image_;
using RosCameraInfo = sensor_msgs_msg_dds__CameraInfo_;

struct RosType {
  const dds_topic_descriptor_t& descriptor;
  const char* hash;  ///< RIHS01, of REP-2016 (tests/sharing/ros_type_hashes.py)
  /// Name on the wire.
  const char* name() const { return descriptor.m_typename; }
};
/// Type of a message that is sent on a topic.
template <class T>
RosType rosTypeOf();
template <>
RosType rosTypeOf<RosPoseStamped>();
template <>
RosType rosTypeOf<RosWrenchStamped>();
template <>
RosType rosTypeOf<RosTFMessage>();
template <>
RosType rosTypeOf<RosPointCloud2>();
template <>
RosType rosTypeOf<RosImage>();
template <>
RosType rosTypeOf<RosCameraInfo>();

/// Quality of service of a topic.
enum class RosDelivery {
  reliable,    ///< volatile: ROS's default
  latched,     ///< keeps the last one for late joiners (transient local)
  bestEffort,  ///< volatile, as sensors send; as a reader, matches every writer
};
Qos rosQos(RosDelivery delivery, const RosType& type);

/// Prefix of topic names on the wire.
inline const std::string kRosTopics = "rt/";
/// "camera/points" for that or "/camera/points". Throws UsageError for an invalid ROS name.
std::string rosName(const std::string& name);

/// A participant like that of a ROS node.
Participant rosParticipant(const NetworkConfig& network);

/// A topic and its writer.
template <class T>
class RosPublisher {
 public:
  RosPublisher(dds_entity_t participant, const std::string& topic, RosDelivery delivery)
      : topic_(participant, rosTypeOf<T>().descriptor, topic),
        writer_(participant, topic_, rosQos(delivery, rosTypeOf<T>())) {}
  bool write(const T& message) const { return writer_.write(message); }
  operator dds_entity_t() const { return writer_; }  // NOLINT: passed as its handle to every function of DDS

 private:
  Topic<T> topic_;
  Writer<T> writer_;
};

/// Nanoseconds since 1970.
void setStamp(RosHeader& header, std::int64_t time_ns);
inline std::int64_t stampOf(const RosHeader& header) {
  return std::int64_t{header.stamp.sec} * 1'000'000'000 + header.stamp.nanosec;
}

}  // namespace palpate::sharing
