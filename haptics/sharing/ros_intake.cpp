#include "haptics/sharing/ros_intake.hpp"

#include <fmt/ranges.h>

#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

RosWriters::RosWriters(dds_entity_t participant, std::string topic)
    : discovered_(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION), topic_(kRosTopics + std::move(topic)) {}

const std::vector<std::string>& RosWriters::types() {
  constexpr std::size_t kMax = 16;  // per topic, however many are announced
  discovered_.take([&](const dds_builtintopic_endpoint_t& writer) {
    if (topic_ != writer.topic_name || types_.size() == kMax) return;
    if (std::ranges::count(types_, writer.type_name) == 0) types_.emplace_back(writer.type_name);
  });
  return types_;
}

std::string rosTypeInWords(const std::string& type) {
  std::string words = printable(type.c_str());
  const std::size_t inner = words.find("::dds_::");
  if (inner == std::string::npos || !words.ends_with('_')) return words;
  words = words.substr(0, inner) + "/" + words.substr(inner + 8, words.size() - inner - 9);
  const std::size_t package = words.find("::");
  return package == std::string::npos ? words : words.replace(package, 2, "/");
}

std::optional<std::string> requireSent(const std::string& topic, RosWriters& writers,
                                       std::initializer_list<const char*> types) {
  const std::vector<std::string>& sent = writers.types();
  for (const char* type : types)
    if (std::ranges::count(sent, type) > 0) return type;
  if (sent.empty()) return std::nullopt;
  std::vector<std::string> heard;
  for (const char* type : types) heard.push_back(rosTypeInWords(type));
  throw NetworkError("ros:{}: the topic has type {}, not {}", topic, rosTypeInWords(sent.front()),
                     fmt::join(heard, " or "));
}

TakenRosPoints takeMessage(const RosPointCloud2& message, Log* log) {
  std::vector<RosField> fields;
  for (std::uint32_t i = 0; i < message.fields._length; ++i) {
    const RosPointField& field = message.fields._buffer[i];
    fields.push_back(
        {.name = field.name ? field.name : "", .offset = field.offset, .type = field.datatype, .count = field.count});
  }
  return takeRosPoints({.height = message.height,
                        .width = message.width,
                        .fields = fields,
                        .isBigEndian = message.is_bigendian,
                        .pointStep = message.point_step,
                        .rowStep = message.row_step,
                        .data = {message.data._buffer, message.data._length}},
                       log);
}

}  // namespace palpate::sharing
