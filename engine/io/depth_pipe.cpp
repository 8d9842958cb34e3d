#include "engine/io/depth_pipe.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/io/camera_text.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 16;
constexpr std::size_t kLongestHead = std::size_t{1} << 16, kMaxFrameLine = 2048;  // bytes
constexpr std::string_view kFrameWord = "frame ";
constexpr std::size_t kDepthBytes = 2, kColorBytes = 3;  // of a pixel

}  // namespace

DepthPipe::DepthPipe(int descriptor, std::string name, double depthScale)
    : input_(descriptor), name_(std::move(name)), buffer_(kChunk) {
  const auto line = peekLine(kLongestHead);
  if (!line) throw Error("{}: ends before the line of JSON that says what its frames are", name_);
  try {
    if (line->size() == kLongestHead) throw Error("is too long to be one");
    const CameraText text = parseCamera(*line);
    if (text.format != "z16" && text.format != "z16+rgb8")
      throw Error("\"format\" is {}; expected z16 or z16+rgb8", inQuotes(text.format));
    if (depthScale == 0 && !text.depthScale) throw Error("has no \"depth_scale\", the values per metre");
    camera_ = text.camera;
    depthScale_ = depthScale != 0 ? depthScale : *text.depthScale;
    hasColors_ = text.format == "z16+rgb8";
    pose_ = text.pose;
    begin_ += line->size() + 1;
  } catch (const Error& error) {
    throw Error("{}: its first line, {}, {}", name_, inQuotes(*line), error.what());
  }
}

void DepthPipe::rewind() { throw Error("{}: a pipe cannot be rewound", name_); }

std::string_view DepthPipe::unread() const {
  return {reinterpret_cast<const char*>(buffer_.data()) + begin_, end_ - begin_};
}

// False if the input ends early or is stopped.
bool DepthPipe::fill(std::size_t wanted) {
  if (begin_ > 0 && end_ - begin_ < wanted) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= std::exchange(begin_, 0);
  }
  while (end_ - begin_ < wanted) {
    // The buffer grows only after it was filled with bytes that exist.
    if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
    const std::size_t count = input_.read(std::span(buffer_).subspan(end_));
    if (count == 0) return false;
    end_ += count;
  }
  return true;
}

// The next line without its end. Nothing if the input ends early; a line that is too long is truncated.
std::optional<std::string> DepthPipe::peekLine(std::size_t longest) {
  for (std::size_t seen = 0;;) {
    const std::size_t end = unread().find('\n', seen);
    if (end != std::string_view::npos || unread().size() >= longest)
      return std::string(unread().substr(0, std::min(end, longest)));
    seen = unread().size();
    if (!fill(seen + 1)) return std::nullopt;
  }
}

std::optional<DepthPipe::FrameLine> DepthPipe::parseLine(std::string_view line) {
  if (!line.starts_with(kFrameWord)) return std::nullopt;
  line.remove_prefix(kFrameWord.size());
  const auto time_s = textNumber<double>(takeWord(line));
  if (!time_s || !std::isfinite(*time_s)) return std::nullopt;
  FrameLine frame{.time_s = *time_s, .pose = {}};
  std::array<double, 16> rows{};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::string_view word = takeWord(line);
    if (k == 0 && word.empty()) return frame;
    const auto value = textNumber<double>(word);
    if (!value) return std::nullopt;
    rows[k] = *value;
  }
  if (!takeWord(line).empty()) return std::nullopt;
  frame.pose = cameraPose(rows);
  return frame;
}

void DepthPipe::lose(std::string_view why) const { throw Error("{}: frame {} {}", name_, count_ - 1, why); }

// Skips to the possible beginning of the next frame's line; to the end if there is none.
void DepthPipe::skipToFrame() {
  do {
    const std::size_t next = unread().find(kFrameWord, 1);
    if (next != std::string_view::npos) {
      begin_ += next;
      return;
    }
    begin_ = end_ - std::min(kFrameWord.size() - 1, unread().size() - 1);  // may end with its beginning
  } while (fill(kFrameWord.size()) && !unread().starts_with(kFrameWord));
  if (!unread().starts_with(kFrameWord)) begin_ = end_;
}

// The line of the next frame; nothing at the end. Other data is skipped up to the next possible line, and counts as one
// lost frame.
std::optional<DepthPipe::FrameLine> DepthPipe::findLine() {
  while (fill(1) && unread().front() == '\n') ++begin_;
  if (unread().empty()) return std::nullopt;
  fill(kFrameWord.size());
  std::string why;
  if (unread().starts_with(kFrameWord)) {
    const auto line = peekLine(kMaxFrameLine);
    if (input_.isStopped()) return std::nullopt;
    ++count_;
    if (!line) {
      begin_ = end_;
      lose("ends within its first line");
    }
    try {
      if (const auto found = line->size() < kMaxFrameLine ? parseLine(*line) : std::nullopt) {
        begin_ += line->size() + 1;
        return found;
      }
      why = fmt::format("begins with {}; expected a time, followed by 16 numbers or none", inQuotes(*line));
    } catch (const Error& error) {
      why = error.what();
    }
  } else {
    if (input_.isStopped()) return std::nullopt;
    ++count_;
    why =
        fmt::format("begins with {} instead of 'frame'; the input up to the next frame is skipped", inQuotes(unread()));
  }
  skipToFrame();
  lose(why);
}

// Offset of the next frame's line within the bytes of a frame; `bytes` if it is not there, as expected.
std::size_t DepthPipe::tornAt(std::size_t bytes) const {
  const std::string_view pixels = unread().substr(0, bytes);
  for (std::size_t at = pixels.find(kFrameWord); at != pixels.npos; at = pixels.find(kFrameWord, at + 1)) {
    const std::string_view rest = pixels.substr(at, kMaxFrameLine);
    const std::size_t end = rest.find('\n');
    const bool isCutOff =
        end == rest.npos && rest.find_first_not_of("0123456789.eE+- ", kFrameWord.size()) == rest.npos;
    try {
      if (isCutOff || (end != rest.npos && parseLine(rest.substr(0, end)))) return at;
    } catch (const Error&) {
      return at;  // a line with an invalid pose
    }
  }
  return bytes;
}

void DepthPipe::take(const std::byte* from, DepthFrame& frame) const {
  static_assert(std::endian::native == std::endian::little, "depth is little-endian");
  const std::size_t pixels = std::size_t{camera_.width} * camera_.height;
  frame.depth_m.resize(pixels);
  const auto metres = static_cast<float>(1 / depthScale_);
  for (std::size_t i = 0; i < pixels; ++i) {
    std::uint16_t value;
    std::memcpy(&value, from + kDepthBytes * i, sizeof value);
    frame.depth_m[i] = static_cast<float>(value) * metres;
  }
  frame.colors.resize(hasColors_ ? pixels : 0);
  if (hasColors_) std::memcpy(frame.colors.data(), from + kDepthBytes * pixels, kColorBytes * pixels);
}

bool DepthPipe::next(DepthFrame& frame) {
  const std::optional<FrameLine> line = findLine();
  if (!line) return false;
  frame.number = count_ - 1;
  const std::size_t bytes =
      std::size_t{camera_.width} * camera_.height * (kDepthBytes + (hasColors_ ? kColorBytes : 0));
  const bool isWhole = fill(bytes);
  if (input_.isStopped()) return false;
  const std::size_t there = std::min(bytes, unread().size()), torn = tornAt(there);
  if (torn < there || !isWhole) {
    begin_ += torn;
    lose(fmt::format("has {} of its {} bytes; {}", torn, bytes,
                     torn < there ? "the next one follows" : "there it ends"));
  }
  const std::byte* const pixels = buffer_.data() + begin_;  // valid until the next read
  begin_ += bytes;
  if (last_s_ && !(line->time_s > *last_s_))
    lose(fmt::format("has the time {} s, which is not after {} s", line->time_s, *last_s_));
  const std::optional<CameraPose>& pose = line->pose ? line->pose : pose_;
  if (last_s_ && pose.has_value() != hasPoses_)
    lose(fmt::format("has {} pose, and the first one had {}", pose ? "a" : "no", pose ? "none" : "one"));
  take(pixels, frame);
  hasPoses_ = pose.has_value();
  if (!first_s_) first_s_ = line->time_s;
  last_s_ = line->time_s;
  frame.time_s = line->time_s - *first_s_;
  frame.pose = pose;
  return true;
}

}  // namespace palpate
