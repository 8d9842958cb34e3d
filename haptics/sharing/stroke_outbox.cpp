#include "haptics/sharing/stroke_outbox.hpp"

#include <utility>

namespace palpate::sharing {

namespace {

constexpr std::size_t kMaxUnackedPieces = 4096;  // meanwhile edits are merged, each point once

}  // namespace

void StrokeOutbox::add(const MadeState& made) {
  const auto [queued, isFirst] = queued_.try_emplace(made.state.number, made);
  if (isFirst)
    queue_.push_back(made.state.number);
  else
    queued->second.followedBy(made);
}

const StrokePiece* StrokeOutbox::nextPiece(std::size_t most) {
  if (toSend_ < unacked_.size()) return &unacked_[toSend_++];
  if (queue_.empty() || unacked_.size() >= kMaxUnackedPieces) return nullptr;
  StrokePiece piece{.number = ++lastPiece_, .states = {}};
  const bool replaces = queued_.at(queue_.front()).replaced.has_value();
  if (replaces) most -= most / 9;
  while (!queue_.empty() && piece.states.size() < most) {
    const std::uint32_t point = queue_.front();
    const auto state = queued_.find(point);
    if (state->second.replaced.has_value() != replaces) break;
    queue_.pop_front();
    piece.states.push_back(state->second.state);
    if (replaces) piece.replaced.push_back(*state->second.replaced);
    pending_[point] = piece.number;
    queued_.erase(state);
  }
  sentStates_ += piece.states.size();
  unacked_.push_back(std::move(piece));
  toSend_ = unacked_.size();
  return &unacked_.back();
}

std::vector<std::uint32_t> StrokeOutbox::taken(std::uint64_t upTo) {
  std::vector<std::uint32_t> settled;
  while (!unacked_.empty() && unacked_.front().number <= upTo) {
    for (const PointState& state : unacked_.front().states) {
      const auto own = pending_.find(state.number);
      if (own == pending_.end() || own->second != unacked_.front().number) continue;
      pending_.erase(own);
      if (!queued_.contains(state.number)) settled.push_back(state.number);
    }
    unacked_.pop_front();
    if (toSend_ > 0) --toSend_;
  }
  return settled;
}

void StrokeOutbox::sendAgain() {
  resent_ += toSend_;
  toSend_ = 0;
}

}  // namespace palpate::sharing
