#include "haptics/sharing/version_watch.hpp"

#include <charconv>
#include <string_view>

#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

namespace {

constexpr std::string_view kSays = "palpate=";

// Nothing if the participant is not palpate's, or states no number.
std::optional<std::uint32_t> versionOf(const dds_builtintopic_participant_t& participant) {
  void* data = nullptr;
  std::size_t size = 0;
  if (participant.qos == nullptr || !dds_qget_userdata(participant.qos, &data, &size) || data == nullptr)
    return std::nullopt;
  const std::string text(static_cast<const char*>(data), size);
  dds_free(data);
  std::uint32_t version = 0;
  if (!text.starts_with(kSays)) return std::nullopt;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + kSays.size(), end, version);
  if (read.ec != std::errc() || read.ptr == end || *read.ptr != ';') return std::nullopt;
  return version;
}

}  // namespace

Qos versionQos(std::uint32_t version) {
  Qos qos(dds_create_qos());
  const std::string text = fmt::format("{}{};", kSays, version);
  dds_qset_userdata(qos.get(), text.data(), text.size());
  return qos;
}

VersionWatch::VersionWatch(const Participant& participant)
    : reader_(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr), "a reader") {}

std::set<std::uint32_t> VersionWatch::fresh() {
  std::set<std::uint32_t> versions;
  while (true) {
    constexpr std::uint32_t kAtOnce = 16;
    void* samples[kAtOnce] = {};
    dds_sample_info_t about[kAtOnce];
    const auto count = checked(dds_take(reader_, samples, about, kAtOnce, kAtOnce), "participants");
    for (dds_return_t i = 0; i < count; ++i) {
      if (!about[i].valid_data) continue;
      const auto version = versionOf(*static_cast<const dds_builtintopic_participant_t*>(samples[i]));
      constexpr std::size_t kMaxKnown = 16;  // more are ignored, in case they are made up
      if (version && *version != kVersion && known_.size() < kMaxKnown && known_.insert(*version).second)
        versions.insert(*version);
    }
    if (count > 0) dds_return_loan(reader_, samples, count);
    if (count < static_cast<dds_return_t>(kAtOnce)) return versions;
  }
}

}  // namespace palpate::sharing
