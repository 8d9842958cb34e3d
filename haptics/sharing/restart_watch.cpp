#include "haptics/sharing/restart_watch.hpp"

namespace palpate::sharing {

RestartWatch::RestartWatch(const Participant& participant, const Id& session)
    : session_(session),
      topic_(factsOf(participant, session_)),
      reader_(participant, topic_, keepingInstances(reliableQos(true), 1)) {}

std::optional<Restarts> RestartWatch::fresh() {
  constexpr double kApart_s = 0.5;
  reader_.take([&](const Facts& facts) {
    if (!isSame(facts.session, session_)) return;
    heard_ = {.count = facts.restarts, .why = printable(facts.why)};
    if (!told_) told_ = heard_.count;
  });
  if (!told_ || heard_.count == *told_ || (lastTold_ && lastTold_->elapsed_s() < kApart_s)) return std::nullopt;
  lastTold_.emplace();
  const std::uint32_t before = *told_;
  told_ = heard_.count;
  if (heard_.count < before) return std::nullopt;  // no palpate server sends that
  return Restarts{.count = heard_.count - before, .why = heard_.why};
}

}  // namespace palpate::sharing
