// States of the GPU question, and the transitions between them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "engine/core/check.hpp"

namespace palpate {

enum class QuestionState {
  idle,            ///< nothing is asked; the lists of the last question may run again
  waitingForPose,  ///< submitted ahead: it waits on the GPU until the host has written its pose
  asked,           ///< in flight, in the tick of its pose
  late,            ///< in flight after that tick was closed
  answered,        ///< answered in that tick, which is still open
  ending           ///< answered and the tick closed; the driver has not yet reported the end of its lists
};

enum class QuestionEvent {
  submittedAhead,
  withdrawn,
  asked,     ///< its pose is set
  answered,  ///< the host has seen the whole answer
  tickClosed,
  ended  ///< its lists may run again
};

struct QuestionTransition {
  QuestionState from;
  QuestionEvent event;
  QuestionState to;
};

/// All transitions.
inline constexpr std::array kQuestionTransitions{
    QuestionTransition{QuestionState::idle, QuestionEvent::submittedAhead, QuestionState::waitingForPose},
    QuestionTransition{QuestionState::idle, QuestionEvent::asked, QuestionState::asked},
    QuestionTransition{QuestionState::waitingForPose, QuestionEvent::asked, QuestionState::asked},
    QuestionTransition{QuestionState::waitingForPose, QuestionEvent::withdrawn, QuestionState::idle},
    QuestionTransition{QuestionState::asked, QuestionEvent::answered, QuestionState::answered},
    QuestionTransition{QuestionState::asked, QuestionEvent::tickClosed, QuestionState::late},
    QuestionTransition{QuestionState::late, QuestionEvent::answered, QuestionState::ending},
    QuestionTransition{QuestionState::answered, QuestionEvent::tickClosed, QuestionState::ending},
    QuestionTransition{QuestionState::ending, QuestionEvent::ended, QuestionState::idle}};

inline constexpr std::array<std::string_view, 6> kQuestionStateNames{"idle", "waitingForPose", "asked",
                                                                     "late", "answered",       "ending"};
inline constexpr std::array<std::string_view, 6> kQuestionEventNames{"submittedAhead", "withdrawn",  "asked",
                                                                     "answered",       "tickClosed", "ended"};

/// The state after an event; nullopt if the event is not allowed in that state.
constexpr std::optional<QuestionState> stateAfter(QuestionState state, QuestionEvent event) {
  for (const QuestionTransition& transition : kQuestionTransitions)
    if (transition.from == state && transition.event == event) return transition.to;
  return std::nullopt;
}

/// A question's state; changes only by these transitions.
class QuestionProgress {
 public:
  QuestionState state() const { return state_; }
  /// Stops the program if the event is not allowed.
  void happened(QuestionEvent event) {
    const std::optional<QuestionState> next = stateAfter(state_, event);
    if (!next)
      stopOnBug(__FILE__, __LINE__, "no such transition",
                fmt::format(" (state {}, event {})", kQuestionStateNames[static_cast<std::size_t>(state_)],
                            kQuestionEventNames[static_cast<std::size_t>(event)]));
    state_ = *next;
  }

 private:
  QuestionState state_ = QuestionState::idle;
};

}  // namespace palpate
