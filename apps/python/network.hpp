// Networks and sessions of others, as Python names them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "apps/python/arrays.hpp"

namespace palpate::python {

/// Interface, peers and domain, as palpate.Network has them.
using NetworkTuple =
    std::tuple<std::optional<std::string>, std::vector<std::string>, std::uint32_t, std::optional<std::string>>;

/// Keeps the words that it points to.
class Network {
 public:
  explicit Network(NetworkTuple given);
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;
  const pp_network* get() const { return &network_; }
  /// What waits on it, without Python's lock: ends with what a signal raises in Python (Ctrl+C), which this throws, and
  /// otherwise with what `call` throws.
  template <class Call>
  auto waiting(Call&& call) const {
    try {
      if constexpr (std::is_void_v<std::invoke_result_t<Call>>) {
        call();
        throwRaised();
      } else {
        auto result = call();
        throwRaised();
        return result;
      }
    } catch (const pp::Error&) {
      throwRaised();
      throw;
    }
  }

 private:
  static std::int32_t isInterrupted(void* self);
  void throwRaised() const;

  NetworkTuple given_;
  std::vector<const char*> peers_;
  pp_network network_ = pp_default_network();
  mutable std::shared_ptr<py::error_already_set> raised_;  // by what Python does at a signal
};

/// Name, network, hand, read_only and patience_s, as palpate.Join has them.
using JoinTuple = std::tuple<std::string, NetworkTuple, std::optional<std::string>, bool, double, bool>;
/// Without Python's lock.
pp::Session join(const JoinTuple& how, const pp_session_options& options);

}  // namespace palpate::python
