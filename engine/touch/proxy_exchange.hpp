// What the host and the GPU tell each other about a proxy: its state with a question, its sample as the answer.
#pragma once

#include <optional>

#include "engine/contact/proxy_tracker.hpp"
#include "engine/touch/question_pipeline.hpp"

namespace palpate {

/// The proxy state passed to the GPU with a question; empty: the GPU's own. Positions relative to the cloud's origin.
shared::ContactState stateOf(const std::optional<ProxyTracker::State>& state);

/// The proxy state for the next tick after the GPU's answer to a HIP, relative to the cloud's origin, at a time.
ProxyTracker::State proxyStateOf(const shared::ContactSample& sample, const DVec3& hip, double time_s);

/// The contact at a HIP, in file coordinates, as answered to the last question.
Contact contactOf(const shared::ContactSample& sample, const DVec3& hip, const QuestionPipeline& questions);

}  // namespace palpate
