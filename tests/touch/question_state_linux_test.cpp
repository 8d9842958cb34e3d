// The states of a question and their transitions, without a GPU.
#include "engine/touch/question_state.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <set>
#include <vector>

namespace palpate::question_state_test {

namespace {

template <std::size_t kCount, class Enum>
std::vector<Enum> allOf(const std::array<std::string_view, kCount>&, Enum first) {
  std::vector<Enum> all;
  for (std::size_t i = 0; i < kCount; ++i) all.push_back(static_cast<Enum>(static_cast<std::size_t>(first) + i));
  return all;
}

const std::vector<QuestionState> kStates = allOf(kQuestionStateNames, QuestionState::idle);
const std::vector<QuestionEvent> kEvents = allOf(kQuestionEventNames, QuestionEvent::submittedAhead);

/// All states reachable through any events.
std::set<QuestionState> reachableFrom(QuestionState from) {
  std::set<QuestionState> seen{from};
  std::vector<QuestionState> next{from};
  while (!next.empty()) {
    const QuestionState state = next.back();
    next.pop_back();
    for (const QuestionEvent event : kEvents)
      if (const auto to = stateAfter(state, event); to && seen.insert(*to).second) next.push_back(*to);
  }
  return seen;
}

QuestionProgress progressAt(const std::vector<QuestionEvent>& events) {
  QuestionProgress progress;
  for (const QuestionEvent event : events) progress.happened(event);
  return progress;
}

/// Shortest sequence of events from idle to a state.
std::vector<QuestionEvent> wayTo(QuestionState state) {
  std::vector<std::vector<QuestionEvent>> ways{{}};
  for (std::size_t i = 0;; ++i) {
    REQUIRE(i < ways.size());
    const QuestionState at = progressAt(ways[i]).state();
    if (at == state) return ways[i];
    if (ways[i].size() > kStates.size()) continue;
    for (const QuestionEvent event : kEvents)
      if (stateAfter(at, event)) {
        ways.push_back(ways[i]);
        ways.back().push_back(event);
      }
  }
}

/// Whether the event aborts a program whose question is in the state of `progress`.
bool stops(QuestionProgress progress, QuestionEvent event) {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    std::signal(SIGABRT, SIG_DFL);  // replaces the test framework's handler
    std::freopen("/dev/null", "w", stderr);
    progress.happened(event);
    _exit(0);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
}

}  // namespace

TEST_CASE("each transition of a question leads to the state in the table, and any other stops the program") {
  for (const QuestionState state : kStates)
    for (const QuestionEvent event : kEvents) {
      CAPTURE(kQuestionStateNames[static_cast<std::size_t>(state)]);
      CAPTURE(kQuestionEventNames[static_cast<std::size_t>(event)]);
      std::vector<QuestionState> to;
      for (const QuestionTransition& transition : kQuestionTransitions)
        if (transition.from == state && transition.event == event) to.push_back(transition.to);
      REQUIRE(to.size() <= 1);  // one event leads to one state
      QuestionProgress progress = progressAt(wayTo(state));
      REQUIRE(progress.state() == state);
      if (to.empty()) {
        CHECK_FALSE(stateAfter(state, event));
        CHECK(stops(progress, event));
      } else {
        progress.happened(event);
        CHECK(progress.state() == to[0]);
      }
    }
}

TEST_CASE("every state of a question is reached from idle, and idle from every state") {
  CHECK(QuestionProgress().state() == QuestionState::idle);
  CHECK(reachableFrom(QuestionState::idle).size() == kStates.size());
  for (const QuestionState state : kStates) {
    CAPTURE(kQuestionStateNames[static_cast<std::size_t>(state)]);
    CHECK(reachableFrom(state).contains(QuestionState::idle));
  }
}

TEST_CASE("every event of a question occurs in the table") {
  std::set<QuestionEvent> found;
  for (const QuestionTransition& transition : kQuestionTransitions) found.insert(transition.event);
  CHECK(found.size() == kEvents.size());
}

TEST_CASE("a question can be answered in time, late or ahead, or be withdrawn") {
  using enum QuestionEvent;
  CHECK(progressAt({asked, answered, tickClosed}).state() == QuestionState::ending);
  CHECK(progressAt({asked, tickClosed}).state() == QuestionState::late);
  CHECK(progressAt({asked, tickClosed, answered, ended}).state() == QuestionState::idle);
  CHECK(progressAt({submittedAhead, asked, answered, tickClosed, ended}).state() == QuestionState::idle);
  CHECK(progressAt({submittedAhead, withdrawn}).state() == QuestionState::idle);
}

}  // namespace palpate::question_state_test
