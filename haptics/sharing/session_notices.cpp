#include "haptics/sharing/session_notices.hpp"

#include <algorithm>
#include <utility>

namespace palpate::sharing {

namespace {

constexpr std::size_t kMaxKnown = 1000;  // more are ignored, in case the network is flooded

constexpr double kOthers_s = 1;  // time to find another session of the same name
constexpr double kNamePoll_s = 0.1;
constexpr double kYoung_s = 10;  // later it has clients to lose

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

SessionName::SessionName(dds_entity_t participant, const Topics& topics, std::string name, Log* log)
    : name_(std::move(name)),
      log_(log),
      writer_(participant, topics.notices, reliableQos(true)),
      others_(participant, topics) {}

void SessionName::requireFree(const StopSign& stop) {
  for (const SessionNotice& other : others_.listen(kOthers_s, stop))
    if (other.name == name_)
      throw NetworkError("a session named '{}' is served already, by {}; give this one another name", name_,
                         other.host);
}

void SessionName::announce(const Notice& notice) {
  session_ = idOf(notice.session);
  announced_ns_ = dds_time();
  writer_.writeAt(notice, announced_ns_);
  sinceAnnounced_ = {};
}

void SessionName::watch() {
  if (sinceLook_.elapsed_s() < kNamePoll_s) return;
  sinceLook_ = {};
  const bool isYoung = sinceAnnounced_.elapsed_s() < kYoung_s;
  for (const SessionNotice& other : others_.known()) {
    if (other.name != name_ || other.session == session_) continue;
    const bool isLater = std::pair(announced_ns_, session_) > std::pair(other.moment_ns, other.session);
    if (isYoung && isLater)
      throw NetworkError(
          "a session named '{}' began at the same time, served by {}, and was announced before this one, which ends; "
          "its clients are notified; give it another name",
          name_, other.host);
    if (isYoung || std::exchange(isTold_, true)) continue;  // the other one is about to end, or this was logged before
    if (log_)
      log_->warn(
          "another session named '{}' is served by {}: neither can be joined by that name until one of them ends",
          name_, other.host);
  }
}

}  // namespace palpate::sharing
