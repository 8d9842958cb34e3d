#include "engine/touch/proxy_exchange.hpp"

namespace palpate {

shared::ContactState stateOf(const std::optional<ProxyTracker::State>& state) {
  if (!state) return {};
  return {.lastHip = Vec3(state->lastHip),
          .touching = !state->touching ? shared::kFree
                      : state->sticks  ? shared::kSticking
                                       : shared::kSliding,
          .spring = Vec3(state->proxy - state->lastHip),
          .face = state->face,
          .facing = Vec3(state->facing),
          .velocity = Vec3(state->velocity),
          .started = state->started ? 1u : 0u};
}

ProxyTracker::State proxyStateOf(const shared::ContactSample& sample, const DVec3& hip, double time_s) {
  const std::uint32_t face = sample.flags >> shared::kSampleFaceShift;
  const bool touching = sample.touching != shared::kFree;
  const DVec3 normal(sample.normal);
  return {.started = true,
          .touching = touching,
          .sticks = sample.touching == shared::kSticking,
          .face = face,
          .facing = touching && face == shared::kFaceBehind ? -normal : normal,
          .lastHip = hip,
          .proxy = hip + DVec3(sample.spring),
          .velocity = DVec3(sample.velocity),
          .time_s = time_s};
}

Contact contactOf(const shared::ContactSample& sample, const DVec3& hip, const QuestionPipeline& questions) {
  return {
      .proxy = hip + DVec3(sample.spring),
      .normal = DVec3(sample.normal),
      .touching = sample.touching != 0,
      .fresh = true,
      .valid = questions.isWhole() && isFinite(sample.spring) && isFinite(sample.normal) && isFinite(sample.velocity),
      .isWithin = sample.touching == shared::kFree && sample.flags >> shared::kSampleFaceShift == shared::kFaceInside,
      .neighbours = sample.neighbours,
      .gpu_us = questions.question().gpu_us,
      .velocity = DVec3(sample.velocity)};
}

}  // namespace palpate
