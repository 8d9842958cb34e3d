// A client's stream of points: what it wants, and the samples that its server sends.
#pragma once

#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/sharing/brick_ledger.hpp"
#include "haptics/sharing/messages.hpp"

namespace palpate::sharing {

/// As Want.
struct Wanted {
  std::uint32_t epoch = 0;
  std::uint64_t taken = 0;
  std::uint32_t every = 1, first = 0;
  bool edits = false;
  std::uint64_t upTo = 0;
  std::vector<Ball> balls = {};
  bool operator==(const Wanted&) const = default;
};

/// Not thread-safe.
class WantedPoints {
 public:
  WantedPoints(const Participant& participant, const Topics& topics, const Id& server, const Id& client);
  void attach(ReaderWait& wait) const { wait.attach(samples_); }
  /// From now on the stream is that of another server of the session's name.
  void follow(const Id& server) { server_ = server; }
  const Id& server() const { return server_; }
  /// Sends what is wanted: soon if it differs from what was sent last, and again and again, as messages may be lost.
  void ask(const Wanted& wanted);
  template <class Take>
  void take(Take&& take) {
    samples_.take([&](const Points& sample) {
      if (isSame(sample.session, server_)) take(sample);
    });
  }
  /// Nothing that is received from now on is kept.
  void close() { samples_ = {}; }

 private:
  Id server_, client_;
  std::string host_ = ownHost();
  Writer<Want> wants_;
  Reader<Points> samples_;
  Wanted asked_;
  std::uint32_t number_ = 0;
  Stopwatch lastAsked_;
};

}  // namespace palpate::sharing
