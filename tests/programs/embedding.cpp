#include "haptics/session/session.hpp"

int main(int, char** words) {
  using namespace palpate;
  Log log;
  const auto cpu = cpuBackend();
  const SessionConfig config{.model = {.file = words[1]}, .hands = {{.path = "builtin:press"}}};
  Session session(config, loadModel(config.model, {.log = log}), {.backend = *cpu});
  const HandSource hand = openHand(config.hands[0], {.model = session.model(), .log = log});
  const OpenHand touching = hand.hand();
  const ServoResult result = session.run({&touching, 1}, {});
  fmt::print("{:.2f} N at most\n", summarize(result.trace()).peakForce_N);
}
