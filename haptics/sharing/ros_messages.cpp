#include "haptics/sharing/ros_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

namespace {

constexpr int kDepth = 10;  // ROS's default
// Timeout of writers with slow readers; the next message follows soon.
constexpr auto kRosPatience = DDS_MSECS(2);

void setUserData(const Qos& qos, const std::string& text) { dds_qset_userdata(qos.get(), text.data(), text.size()); }

// Letters, digits and single underscores; does not begin with a digit.
bool isToken(std::string_view token) {
  return !token.empty() && std::isdigit(static_cast<unsigned char>(token[0])) == 0 &&
         token.find("__") == std::string_view::npos &&
         std::ranges::all_of(token, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

}  // namespace

template <>
RosType rosTypeOf<RosPoseStamped>() {
  return {geometry_msgs_msg_dds__PoseStamped__desc,
          "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"};
}
template <>
RosType rosTypeOf<RosWrenchStamped>() {
  return {geometry_msgs_msg_dds__WrenchStamped__desc,
          "RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77"};
}
template <>
RosType rosTypeOf<RosTFMessage>() {
  return {tf2_msgs_msg_dds__TFMessage__desc, "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"};
}
template <>
RosType rosTypeOf<RosPointCloud2>() {
  return {sensor_msgs_msg_dds__PointCloud2__desc,
          "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"};
}
template <>
RosType rosTypeOf<RosImage>() {
  return {sensor_msgs_msg_dds__Image__desc, "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"};
}

template <>
RosType rosTypeOf<RosCameraInfo>() {
  return {sensor_msgs_msg_dds__CameraInfo__desc,
          "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"};
}

Qos rosQos(RosDelivery delivery, const RosType& type) {
  Qos qos(dds_create_qos());
  const bool isReliable = delivery != RosDelivery::bestEffort, lasts = delivery == RosDelivery::latched;
  dds_qset_reliability(qos.get(), isReliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, kRosPatience);
  dds_qset_durability(qos.get(), lasts ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, lasts ? 1 : kDepth);
  setUserData(qos, fmt::format("typehash={};", type.hash));
  return qos;
}

std::string rosName(const std::string& name) {
  constexpr std::size_t kLongest = 200;
  const std::string_view relative = std::string_view(name).substr(name.starts_with('/') ? 1 : 0);
  bool isName = name.size() <= kLongest;
  for (std::size_t begin = 0; begin <= relative.size();) {
    const std::size_t end = std::min(relative.find('/', begin), relative.size());
    isName = isName && isToken(relative.substr(begin, end - begin));
    begin = end + 1;
  }
  if (!isName)
    throw UsageError(
        "ros: '{}' is not a valid name: letters, digits and single underscores between single slashes, none beginning "
        "with a digit",
        printable(name.c_str()));
  return std::string(relative);
}

Participant rosParticipant(const NetworkConfig& network) {
  Qos qos(dds_create_qos());
  setUserData(qos, "enclave=/;");
  return Participant(network, std::move(qos));
}

void setStamp(RosHeader& header, std::int64_t time_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  header.stamp.sec = static_cast<std::int32_t>(time_ns / kSecond);
  header.stamp.nanosec = static_cast<std::uint32_t>(time_ns % kSecond);
}

}  // namespace palpate::sharing
