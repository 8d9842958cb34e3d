#include "haptics/sharing/wanted_points.hpp"

namespace palpate::sharing {

namespace {

constexpr double kRepeat_s = 0.05;  // between two requests if nothing is new
constexpr double kNews_s = 0.005;   // and if something is

}  // namespace

WantedPoints::WantedPoints(const Participant& participant, const Topics& topics, const Id& server, const Id& client)
    : server_(server),
      client_(client),
      wants_(participant, topics.wants, bestEffortQos()),
      samples_(participant, topics.points, reliableQos(false, partitionOf(client))) {}

void WantedPoints::ask(const Wanted& wanted) {
  const bool begins = wanted.epoch != asked_.epoch;
  if (!begins && lastAsked_.elapsed_s() < (wanted == asked_ ? kRepeat_s : kNews_s)) return;
  lastAsked_ = {};
  asked_ = wanted;
  std::vector<palpate_sharing_Ball> balls;
  for (const Ball& ball : wanted.balls)
    balls.push_back({.center = {ball.center.x, ball.center.y, ball.center.z}, .radius = ball.radius});
  Want want{};
  set(want.session, server_);
  set(want.client, client_);
  put(want.host, host_);
  want.number = ++number_;
  want.epoch = wanted.epoch;
  want.taken = wanted.taken;
  want.every = wanted.every;
  want.first = wanted.first;
  want.edits = wanted.edits;
  want.upTo = wanted.upTo;
  give(want.balls, balls);
  wants_.write(want);
}

}  // namespace palpate::sharing
