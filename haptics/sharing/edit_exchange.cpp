#include "haptics/sharing/edit_exchange.hpp"

#include <algorithm>

#include "engine/core/check.hpp"

namespace palpate::sharing {

EditExchange::EditExchange(std::vector<PointState> points, std::size_t mostOffered)
    : shown_(std::move(points)), mostOffered_(mostOffered), digest_(shown_) {
  offer_.reserve(mostOffered_);
}

void EditExchange::set(const PointState& state) {
  PALPATE_CHECK_LT(state.number, shown_.size());
  PointState& shown = shown_[state.number];
  digest_.replace(shown, state);
  shown = state;
}

// It comes after all known edits of others, including those in flight to the back end.
void EditExchange::made(const PointState& state, Replaces replaces) {
  const std::uint32_t point = state.number;
  PALPATE_CHECK_LT(point, shown_.size());
  MadeState made{.state = state};
  if (replaces == Replaces::known) made.replaced = PointDigest::of(shown_[point]);
  set(state);
  waiting_.erase(point);
  if (inFlight_.contains(point)) overtaken_[point] = state;
  outbox_.add(made);
}

void EditExchange::received(std::span<const PointState> states) {
  for (const PointState& state : states) {
    const std::uint32_t point = state.number;
    const auto given = inFlight_.find(point);
    PALPATE_CHECK(given != inFlight_.end());
    set(given->second);  // as offered: the back end may store less of it
    ++receivedStates_;
    // The hand's earlier edit is later in the server's order, unless another edit of the point was received since.
    if (const auto own = overtaken_.find(point); own != overtaken_.end()) waiting_.try_emplace(point, own->second);
    inFlight_.erase(given);
  }
  // Changes that were not taken are offered again, unless the hand has changed the point since.
  for (const auto& [point, state] : inFlight_)
    if (!overtaken_.contains(point)) waiting_.try_emplace(point, state);
  inFlight_.clear();
  overtaken_.clear();
  isOffered_ = false;
}

void EditExchange::follow(const EditBatch& batch) {
  const std::span<const PointState> all = batch.points;
  std::size_t begin = 0;
  for (const EditMark& mark : batch.marks) {
    const auto states = all.subspan(begin, mark.at - begin);
    if (mark.kind == EditMark::Kind::received)
      received(states);
    else
      for (const PointState& state : states)
        made(state, mark.kind == EditMark::Kind::change ? Replaces::known : Replaces::any);
    changesFollowed_ += mark.kind == EditMark::Kind::change;
    begin = mark.at;
  }
  for (const PointState& state : all.subspan(begin)) made(state, Replaces::any);
}

std::span<const PointChange> EditExchange::nextOffer() {
  if (isOffered_) return {};
  // An offer that was not taken is made again, without the points that the hand has changed since.
  for (const auto& [point, state] : inFlight_)
    if (!overtaken_.contains(point)) waiting_.try_emplace(point, state);
  inFlight_.clear();
  overtaken_.clear();
  offer_.clear();
  for (auto next = waiting_.begin(); next != waiting_.end() && offer_.size() < mostOffered_;
       next = waiting_.erase(next)) {
    const auto& [point, state] = *next;
    // Of a removed point only the removal counts; the back end keeps its other values of that moment.
    if (isSameToTheBit(shown_[point], state) || (shown_[point].gone && state.gone)) continue;
    offer_.push_back({.from = shown_[point], .to = state});
    inFlight_.emplace(point, state);
  }
  return offer_;
}

Heard EditExchange::hear(const Results& results) {
  if (const Heard heard = order_.judge(results.epoch, results.sample); heard != Heard::taken) return heard;
  order_.take();
  hasHeard_ = true;
  outbox_.taken(results.acked);
  for (const PointState& state : results.states) {
    const std::uint32_t point = state.number;
    PALPATE_CHECK_LT(point, shown_.size());
    // The hand's edit in flight to the server comes after it.
    if (outbox_.holds(point)) continue;
    waiting_[point] = state;
  }
  upTo_ = results.upTo;
  head_ = results.head;
  serverDigest_ = results.digest;
  return Heard::taken;
}

Resume EditExchange::resumeAll() {
  upTo_ = 0;
  return resume();
}

Resume EditExchange::resume() {
  outbox_.sendAgain();
  return ask();
}

Resume EditExchange::ask() {
  hasHeard_ = false;
  return {.epoch = order_.begin(), .upTo = upTo_};
}

}  // namespace palpate::sharing
