#include "engine/matter/matter_thread.hpp"

#include "engine/core/clock.hpp"
#include "engine/core/processor.hpp"
#include "engine/core/start_thread.hpp"

namespace palpate {

MatterThread::MatterThread(MatterSteps& steps)
    : steps_(steps), spins_(coresToUse() >= kCoresToSpin), thread_(startThread([this] { serve(); })) {}

MatterThread::~MatterThread() {
  stop_.store(true);
  wake_.post();
}

void MatterThread::serve() {
  std::optional<MatterQuestion> question;
  for (wake_.take(); !stop_.load(); wake_.take()) {
    const auto newest = asked_.load();
    if (!newest || (question && newest->time_s == question->time_s)) continue;  // answered after an earlier wake-up
    question = newest;
    answered_.store(steps_.answerTo(*question));
    done_.post();
  }
}

std::optional<MatterAnswer> MatterThread::ask(const MatterQuestion& question, double budget_us) noexcept {
  const Stopwatch watch;
  askedAt_s_ = question.time_s;
  asked_.store(question);
  wake_.post();
  for (;;) {
    if (const auto newest = answered_.load()) last_ = newest;
    if (last_ && last_->question.time_s == question.time_s) return last_;
    if (budget_us <= 0) {
      done_.take();
      continue;
    }
    const double left_us = budget_us - watch.elapsed_us();
    if (left_us <= 0 || (!spins_ && !done_.takeWithin(left_us))) return last_;  // the next sleep takes a late post
  }
}

void MatterThread::finish() {
  while (askedAt_s_) {
    if (const auto newest = answered_.load()) last_ = newest;
    if (last_ && last_->question.time_s == *askedAt_s_) return;
    wake_.post();
    done_.take();
  }
}

}  // namespace palpate
