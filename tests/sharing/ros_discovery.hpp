// What programs discover about each other before a message is sent.
#pragma once

#include <string>

#include "haptics/sharing/dds.hpp"
#include "tests/sharing/own_network.hpp"

namespace palpate {

inline std::string userDataOf(const dds_qos_t* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &data, &size)) return {};
  const std::string text(static_cast<const char*>(data), size);
  dds_free(data);
  return text;
}

/// The first discovered writer of a topic: its type's name and user data; empty without one.
struct DiscoveredWriter {
  std::string type, userData;
};
inline DiscoveredWriter discoveredWriter(dds_entity_t participant, const std::string& topic, double most_s = 5) {
  const sharing::Reader<dds_builtintopic_endpoint_t> reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION);
  DiscoveredWriter found;
  within(most_s, [&] {
    reader.take([&](const dds_builtintopic_endpoint_t& endpoint) {
      if (topic == endpoint.topic_name) found = {endpoint.type_name, userDataOf(endpoint.qos)};
    });
    return !found.type.empty();
  });
  return found;
}

}  // namespace palpate
