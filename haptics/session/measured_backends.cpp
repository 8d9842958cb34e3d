#include "haptics/session/measured_backends.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace palpate {

namespace {

// Reads a positive number from the start of `text`, and removes it.
bool take(std::string_view& text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value) || value <= 0) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

// Reads both; the rest of the line remains.
bool take(std::string_view& line, BackendPair& times) {
  if (!take(line, times.gpu_us) || !line.starts_with(' ')) return false;
  line.remove_prefix(1);
  return take(line, times.cpu_us);
}

constexpr RememberedLines::Kind kKind{
    .firstLine = "palpate back ends, version 1: p99 of a tick on the GPU and on the CPU, us; of",
    .what = "measured back ends",
    .valueLength = [](std::string_view line) {
      std::string_view rest = line;
      BackendPair times;
      return take(rest, times) ? line.size() - rest.size() : 0;
    }};

}  // namespace

MeasuredBackends::MeasuredBackends(std::filesystem::path file) : RememberedLines(std::move(file), kKind) {}

std::optional<BackendPair> MeasuredBackends::recall(std::string_view key,
                                                    const std::function<void(std::string_view)>& damaged) const {
  const std::optional<std::string> value = RememberedLines::recall(key, damaged);
  BackendPair times;
  std::string_view text = value ? std::string_view(*value) : std::string_view();
  return take(text, times) ? std::optional(times) : std::nullopt;
}

void MeasuredBackends::remember(std::string_view key, const BackendPair& times) const {
  RememberedLines::remember(key, fmt::format("{:.1f} {:.1f}", times.gpu_us, times.cpu_us));
}

}  // namespace palpate
