// What programs discover about each other before a message is sent.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "engine/core/clock.hpp"
#include "haptics/sharing/dds.hpp"

namespace palpate {

inline bool comesTrue(const std::function<bool()>& sign, double most_s = 5) {
  const Stopwatch since;
  while (!sign()) {
    if (since.elapsed_s() > most_s) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

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
  const sharing::Entity reader(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
                               "a reader");
  DiscoveredWriter found;
  comesTrue(
      [&] {
        void* samples[64] = {};
        dds_sample_info_t about[64];
        const dds_return_t count = dds_take(reader, samples, about, 64, 64);
        for (dds_return_t i = 0; i < count; ++i) {
          const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
          if (about[i].valid_data && topic == endpoint->topic_name)
            found = {endpoint->type_name, userDataOf(endpoint->qos)};
        }
        if (count > 0) dds_return_loan(reader, samples, count);
        return !found.type.empty();
      },
      most_s);
  return found;
}

}  // namespace palpate
