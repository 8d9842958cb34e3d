#include "haptics/sharing/stroke_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "engine/core/checksum.hpp"
#include "engine/core/error.hpp"
#include "engine/core/packed_state.hpp"
#include "engine/core/system_file.hpp"

namespace palpate::sharing {

namespace {

struct Header {
  std::array<char, 16> magic{'p', 'a', 'l', 'p', 'a', 't', 'e', ' ', 's', 't', 'r', 'o', 'k', 'e', 's', '\n'};
  std::uint64_t version = 1;
  Id session{};
  std::uint64_t points = 0, checksum = 0;  // of the served points
  bool operator==(const Header&) const = default;
};
static_assert(sizeof(Header) == 56);

struct Head {  // of a piece; its states follow
  Id client{};
  std::uint64_t number = 0;
  std::uint64_t states = 0;
  std::uint64_t checksum = 0;  // of the whole piece, with this field 0
};
static_assert(sizeof(Head) == 40);
static_assert(sizeof(PackedState) == 36);

constexpr std::uint64_t kMaxStates = 1024;  // per piece

std::uint64_t checksumOf(Head head, std::span<const PackedState> states) {
  head.checksum = 0;
  Checksum sum;
  sum.add(std::as_bytes(std::span(&head, 1)));
  sum.add(std::as_bytes(states));
  return sum.value();
}

constexpr std::int32_t kMaxSamples = 32'768;  // 1.4 KB each; dropped ones are sent again

}  // namespace

StrokeJournal::StrokeJournal(std::filesystem::path file, std::uint64_t points, std::uint64_t checksum, const Id& fresh,
                             const std::function<void(const Piece&)>& take)
    : file_(std::move(file)), session_(fresh) {
  stream_.reset(openFile(file_, "r+b"));
  if (stream_) {
    if (!holdAlone(stream_.get())) throw FileError(file_, whyNotWritten(EAGAIN));
    goOn(points, checksum, take);
  } else {
    if (errno != ENOENT) throw FileError(file_, fmt::format("cannot be read: {}", std::strerror(errno)));
    stream_.reset(openFile(file_, "wbx"));
    if (!stream_) throw FileError(file_, whyNotWritten(errno));
    if (!holdAlone(stream_.get())) throw FileError(file_, whyNotWritten(EAGAIN));
    begin(points, checksum);
  }
}

void StrokeJournal::begin(std::uint64_t points, std::uint64_t checksum) {
  const Header header{.session = session_, .points = points, .checksum = checksum};
  write(std::as_bytes(std::span(&header, 1)));
}

void StrokeJournal::goOn(std::uint64_t points, std::uint64_t checksum, const std::function<void(const Piece&)>& take) {
  std::FILE* const stream = stream_.get();
  const std::uint64_t size = std::filesystem::file_size(file_);
  Header header;
  if (size < sizeof header || std::fread(&header, sizeof header, 1, stream) != 1 || header.magic != Header().magic)
    throw FileError(file_, "is not a journal of strokes; give another name, or remove it");
  if (header.version != Header().version)
    throw FileError(file_, fmt::format("is a journal of version {}; this palpate knows version 1", header.version));
  if (header.points != points || header.checksum != checksum)
    throw FileError(file_,
                    fmt::format("has the strokes of another model, of {} points; serve that one, or give another name",
                                header.points));
  session_ = header.session;
  std::uint64_t at = sizeof header;
  std::vector<PackedState> entries;
  std::vector<PointState> states;
  while (size - at >= sizeof(Head)) {
    Head head;
    if (std::fread(&head, sizeof head, 1, stream) != 1) throw FileError::atByte(file_, at, "cannot be read");
    if (head.states == 0 || head.states > kMaxStates)
      throw FileError::atByte(file_, at, "is damaged: not a piece of a stroke");
    const std::uint64_t bytes = head.states * sizeof(PackedState);
    if (size - at - sizeof head < bytes) break;
    entries.resize(head.states);
    if (std::fread(entries.data(), bytes, 1, stream) != 1) throw FileError::atByte(file_, at, "cannot be read");
    if (checksumOf(head, entries) != head.checksum) {
      if (at + sizeof head + bytes == size) break;
      throw FileError::atByte(file_, at, "is damaged: a piece of a stroke has a wrong checksum");
    }
    states.resize(entries.size());
    std::ranges::transform(entries, states.begin(), [](const PackedState& entry) { return palpate::stateOf(entry); });
    take({.client = head.client, .number = head.number, .states = states});
    ++pieces_;
    at += sizeof head + bytes;
  }
  tornBytes_ = size - at;
  if (tornBytes_ > 0) {
    std::error_code error;
    std::filesystem::resize_file(file_, at, error);
    if (error) throw FileError(file_, fmt::format("cannot be written: {}", error.message()));
  }
  if (!seekTo(stream, at)) throw FileError(file_, whyNotWritten(errno));
}

void StrokeJournal::write(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) != bytes.size() || std::fflush(stream_.get()) != 0)
    throw FileError(file_, whyNotWritten(errno));
}

void StrokeJournal::add(const Piece& piece) {
  Head head{.client = piece.client, .number = piece.number, .states = piece.states.size()};
  std::vector<PackedState> entries(piece.states.size());
  std::ranges::transform(piece.states, entries.begin(), [](const PointState& state) { return packedState(state); });
  head.checksum = checksumOf(head, entries);
  std::vector<std::byte> bytes(sizeof head + entries.size() * sizeof(PackedState));
  std::memcpy(bytes.data(), &head, sizeof head);
  std::memcpy(bytes.data() + sizeof head, entries.data(), bytes.size() - sizeof head);
  write(bytes);
  ++pieces_;
}

StrokeServer::StrokeServer(const Parts& parts)
    : parts_(parts), strokes_(parts.participant, parts.topics.strokes, keepingLast(reliableQos(false), kMaxSamples)) {
  counts_.sculptors = parts_.points.clients();
  counts_.states = parts_.points.head();
  if (parts_.journal) counts_.pieces = parts_.journal->pieces();
}

void StrokeServer::take() {
  strokes_.take([&](const Stroke& stroke) { take(stroke); });
}

void StrokeServer::take(const Stroke& stroke) {
  if (!isSame(stroke.session, parts_.session)) return;
  const std::span<const State> given(stroke.states._buffer, stroke.states._length);
  states_.clear();
  for (const State& state : given) states_.push_back(pointOf(state));
  const Id client = idOf(stroke.client);
  const SharedPoints::Taken taken = parts_.points.take(
      client, stroke.number, states_, std::span<const std::uint64_t>(stroke.replaced._buffer, stroke.replaced._length));
  counts_.sculptors = parts_.points.clients();
  switch (taken) {
    case SharedPoints::Taken::taken:
      ++counts_.pieces;
      counts_.states += states_.size();
      // As the points are now, since some of them may have kept another state.
      for (PointState& state : states_) state = parts_.points.points()[state.number];
      if (parts_.journal) parts_.journal->add({.client = client, .number = stroke.number, .states = states_});
      break;
    case SharedPoints::Taken::known:
    case SharedPoints::Taken::early:
      ++counts_.again;
      break;
    case SharedPoints::Taken::refused:
      if (counts_.refused++ == 0 && parts_.log)
        parts_.log->say(
            "a piece of a stroke was refused, and others may be: it is invalid, or {} hands have sculpted, which is "
            "the maximum",
            parts_.points.clients());
      break;
  }
}

}  // namespace palpate::sharing
