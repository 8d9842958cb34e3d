#include "engine/io/las_unpacked.hpp"

#include "engine/io/append_bytes.hpp"

namespace palpate {

void LasUnpacked::add(const LasRecord& record) {
  appendBytes(records_, record.head);
  appendBytes(records_, record.data);
  ++count_;
}

void LasUnpacked::addLong(const LasRecord& record) {
  appendBytes(tail_, record.head);
  appendBytes(tail_, record.data);
  ++longCount_;
}

std::vector<std::byte> LasUnpacked::head() const {
  std::size_t recordsEnd = header_.size;
  for (const LasRecord& record : lasRecords({}, header_, head_))
    recordsEnd = record.at + record.head.size() + record.data.size();
  std::vector<std::byte> bytes;
  appendBytes(bytes, head_.first(header_.size));
  appendBytes(bytes, records_);
  appendBytes(bytes, head_.subspan(recordsEnd));
  const auto put = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
  put(96, static_cast<std::uint32_t>(bytes.size()));
  put(100, count_);
  put(104, static_cast<std::uint8_t>(header_.format));
  const std::uint64_t end = bytes.size() + header_.points * header_.pointBytes;
  if (header_.minor >= 3 && header_.waveformsAt >= tailAt_) put(227, header_.waveformsAt - tailAt_ + end);
  if (header_.minor < 4 || header_.longRecords == 0) return bytes;
  const bool all = longCount_ == header_.longRecords;
  put(235, longCount_ == 0 ? std::uint64_t{0} : end + (all ? header_.longRecordsAt - tailAt_ : 0));
  put(243, longCount_);
  return bytes;
}

}  // namespace palpate
