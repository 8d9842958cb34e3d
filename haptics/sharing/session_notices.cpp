#include "haptics/sharing/session_notices.hpp"

#include <algorithm>

#include "engine/core/clock.hpp"

namespace palpate::sharing {

namespace {

constexpr std::size_t kMaxKnown = 1000;  // more are ignored, in case the network is flooded

}  // namespace

SessionNotices::SessionNotices(dds_entity_t participant, const Topics& topics)
    : reader_(participant, topics.notices, keepingInstances(reliableQos(true), kMaxKnown)), wait_(participant) {
  wait_.attach(reader_);
}

void SessionNotices::take() {
  reader_.takeWithEnds([&](const Notice& notice, const dds_sample_info_t& about) {
    if (about.instance_state != DDS_ALIVE_INSTANCE_STATE) {
      std::erase_if(known_, [&](const SessionNotice& one) { return isSame(notice.session, one.session); });
      return;
    }
    SessionNotice known{.session = idOf(notice.session),
                        .version = notice.version,
                        .name = printable(notice.name),
                        .host = printable(notice.host),
                        .model = printable(notice.model),
                        .points = notice.points,
                        .origin = DVec3(notice.origin[0], notice.origin[1], notice.origin[2]),
                        .mm_per_unit = notice.mm_per_unit,
                        .colored = notice.colored,
                        .sculptable = notice.sculptable,
                        .checksum = notice.checksum,
                        .moment_ns = about.source_timestamp};
    const auto same = std::ranges::find(known_, known.session, &SessionNotice::session);
    if (same != known_.end())
      *same = std::move(known);
    else if (known_.size() < kMaxKnown)
      known_.push_back(std::move(known));
  });
}

const std::vector<SessionNotice>& SessionNotices::known() {
  take();
  return known_;
}

std::vector<SessionNotice> SessionNotices::listen(double seconds, const StopSign& stop) {
  const Stopwatch since;
  for (double left = seconds; left > 0; left = seconds - since.elapsed_s()) {
    throwIfStopped(stop);
    wait_.sleep(std::min(left, 0.05));
    take();
  }
  return known_;
}

std::vector<SessionNotice> SessionNotices::listenFor(const std::string& name, double seconds) {
  const Stopwatch since;
  for (double left = seconds; left > 0; left = seconds - since.elapsed_s()) {
    wait_.sleep(std::min(left, 0.05));
    take();
    if (std::ranges::find(known_, name, &SessionNotice::name) != known_.end()) break;
  }
  return known_;
}

}  // namespace palpate::sharing
