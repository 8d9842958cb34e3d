#include "haptics/session/replay_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

namespace {

bool same(const PointState& a, const PointState& b, const Tolerance& tolerance) {
  if (a.gone || b.gone) return a.gone == b.gone && a.number == b.number;
  if (tolerance.value <= 0) return isSameToTheBit(a, b);
  return a.number == b.number && a.color == b.color &&
         tolerance.scale.toMm(glm::distance(DVec3(a.position), DVec3(b.position))) <= tolerance.value;
}

// The edits from one tick's answer to another's, sorted by point, in order for each point.
std::vector<PointState> editsBetween(const EditBatch& edits, std::uint64_t begin, std::uint64_t end) {
  const auto at = [&](std::uint64_t place) {
    return edits.points.begin() + static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(place, edits.points.size()));
  };
  std::vector<PointState> between(at(begin), at(end));
  std::ranges::stable_sort(between, {}, [](const PointState& state) { return state.number; });
  return between;
}

bool sameEdits(const std::vector<PointState>& a, const std::vector<PointState>& b, const Tolerance& tolerance) {
  return std::ranges::equal(a, b, [&](const PointState& x, const PointState& y) { return same(x, y, tolerance); });
}

}  // namespace

ComparableTicks comparableTicks(const SessionRecord& record, double rate_Hz, bool realtime, bool ordered) {
  if (realtime && !ordered)
    return {0, "it took points in the order of their arrival (real time without --deterministic)"};
  bool isLent = false;
  auto next = record.commands.begin();
  for (std::size_t i = 0; i < record.ticks.size(); ++i) {
    const LoggedTick& tick = record.ticks[i];
    bool isCommanded = false;
    for (; next != record.commands.end() && next->tick <= i; ++next) {
      isLent = next->kind == LoggedCommand::Kind::lend;
      isCommanded = true;
    }
    const auto stops = [&](std::string_view what) {
      return ComparableTicks{i, fmt::format("{} at {:.3f} s", what, tick.time_s)};
    };
    if (!record.gaps.empty() && i == record.gaps.front().tick)
      return stops("a part of the log is missing before the tick");
    if (tick.has(LoggedTick::kCommand) && !isCommanded) return stops("a command is missing in the log");
    if (tick.time_s != static_cast<double>(i) / rate_Hz) return stops("a tick was missed");
    if (realtime && !tick.has(LoggedTick::kFresh) && !isLent) return stops("an answer was late");
    if (tick.has(LoggedTick::kEditLeftOut)) return {i + 1, stops("an edit was dropped").because};
    if (tick.edits <= record.countedEdits) continue;
    if (!record.gaps.empty()) return stops("edits are missing in the log");
    return stops(record.mergedEdits > 0 ? "the log fell behind the edits and contains only the latest of them"
                                        : "the log contains no further edits");
  }
  return {record.ticks.size(), {}};
}

Differences compareTicks(const SessionRun& recorded, const SessionRun& again, std::size_t ticks,
                         const Tolerance& tolerance) {
  Differences found{.ticks = ticks};
  std::uint64_t recordedEdits = 0, againEdits = 0;
  for (std::size_t i = 0; i < ticks; ++i) {
    const LoggedTick& old = recorded.ticks[i];
    // A tick missing in the replay counts as one without force.
    const LoggedTick now = i < again.ticks.size() ? again.ticks[i] : LoggedTick{.edits = againEdits};
    const double force_N = glm::distance(old.force_N, now.force_N);
    found.largestForce_N = std::max(found.largestForce_N, force_N);
    const bool forceDiffers = !(force_N <= tolerance.value);
    const bool editsDiffer = !sameEdits(editsBetween(*recorded.edits, recordedEdits, old.edits),
                                        editsBetween(*again.edits, againEdits, now.edits), tolerance);
    recordedEdits = old.edits;
    againEdits = now.edits;
    found.forceTicks += forceDiffers;
    found.editTicks += editsDiffer;
    if ((forceDiffers || editsDiffer) && !found.first_s) found.first_s = old.time_s;
  }
  return found;
}

std::size_t differingPoints(std::span<const PointState> a, std::span<const PointState> b, const Tolerance& tolerance) {
  std::size_t differing = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const PointState none{.gone = true, .number = i};
    differing += !same(i < a.size() ? a[i] : none, i < b.size() ? b[i] : none, tolerance);
  }
  return differing;
}

}  // namespace palpate
