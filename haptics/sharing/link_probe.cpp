#include "haptics/sharing/link_probe.hpp"

namespace palpate::sharing {

namespace {

constexpr double kPing_s = 0.2;

}  // namespace

LinkProbe::LinkProbe(const JoinedSession& session)
    : session_(session),
      pings_(session.participant, session.topics.pings, bestEffortQos()),
      echoes_(session.participant, session.topics.echoes, bestEffortQos()) {}

void LinkProbe::turn() {
  echoes_.take([&](const Ping& echo) {
    if (isSame(echo.session, session_.session) && isSame(echo.client, session_.client))
      statistics_.answered(echo.number, since_.elapsed_s());
  });
  if (lastPing_.elapsed_s() < kPing_s) return;
  lastPing_ = {};
  Ping ping{};
  set(ping.session, session_.session);
  set(ping.client, session_.client);
  ping.number = statistics_.sent(since_.elapsed_s());
  ping.sent_us = since_.elapsed_us();
  pings_.write(ping);
}

}  // namespace palpate::sharing
