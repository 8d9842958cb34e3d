// What ROS 2 programs see of us on the wire, as those of rmw_cyclonedds write it: names of topics and types, and in the
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
  /// On the wire.
  const char* name() const { return descriptor.m_typename; }
};
/// Of one of the messages that are topics.
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

/// How ROS keeps and hands on what is sent.
enum class RosDelivery {
  reliable,    ///< of now: its default
  latched,     ///< and the last one for who comes later (transient local)
  bestEffort,  ///< of now: of sensors; for readers, to whom every writer fits
};
Qos rosQos(RosDelivery delivery, const RosType& type);

/// What stands before the names of topics on the wire.
inline const std::string kRosTopics = "rt/";
/// "camera/points" of that or of "/camera/points". Throws UsageError for what is no name in ROS.
std::string rosName(const std::string& name);

/// A participant as a node of ROS has it.
Participant rosParticipant(const NetworkConfig& network);

/// A topic and what writes to it.
template <class T>
class RosPublisher {
 public:
  RosPublisher(dds_entity_t participant, const std::string& topic, RosDelivery delivery)
      : topic_(participant, rosTypeOf<T>().descriptor, topic),
        writer_(participant, topic_, rosQos(delivery, rosTypeOf<T>())) {}
  bool write(const T& message) const { return writer_.write(message); }
  operator dds_entity_t() const { return writer_; }  // NOLINT: it is its handle wherever DDS wants one

 private:
  Topic<T> topic_;
  Writer<T> writer_;
};

/// Nanoseconds since 1970, as a header has them.
void setStamp(RosHeader& header, std::int64_t time_ns);
inline std::int64_t stampOf(const RosHeader& header) {
  return std::int64_t{header.stamp.sec} * 1'000'000'000 + header.stamp.nanosec;
}

}  // namespace palpate::sharing
