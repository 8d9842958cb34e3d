#include "haptics/sharing/session_name.hpp"

#include <utility>

namespace palpate::sharing {

namespace {

constexpr double kOthers_s = 1;  // time to find another session of the same name
constexpr double kNamePoll_s = 0.1;
constexpr double kYoung_s = 10;  // later it has clients to lose

}  // namespace

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
