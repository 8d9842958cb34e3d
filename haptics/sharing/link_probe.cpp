#include "haptics/sharing/link_probe.hpp"

namespace palpate::sharing {

namespace {

constexpr double kPing_s = 0.2, kFirstPings_s = 0.05;
constexpr std::uint32_t kFirstPings = 8;

}  // namespace

LinkProbe::LinkProbe(const JoinedSession& session)
    : server_(session.session),
      client_(session.client),
      pings_(session.participant, session.topics.pings, bestEffortQos()),
      echoes_(session.participant, session.topics.pings, bestEffortQos(kEchoes)) {}

bool LinkProbe::turn() {
  bool isAnswered = false;
  echoes_.take([&](const Ping& echo) {
    if (!isSame(echo.session, server_) || !isSame(echo.client, client_)) return;
    isAnswered = statistics_.answered(echo.number, since_.elapsed_s()) || isAnswered;
    request_.answered(echo);
  });
  if (lastPing_.elapsed_s() < (sent_ < kFirstPings ? kFirstPings_s : kPing_s)) return isAnswered;
  lastPing_ = {};
  Ping ping{};
  set(ping.session, server_);
  set(ping.client, client_);
  ping.number = sent_ = statistics_.sent(since_.elapsed_s());
  ping.sent_us = since_.elapsed_us();
  ping.write = request_.write();
  pings_.write(ping);
  return isAnswered;
}

}  // namespace palpate::sharing
