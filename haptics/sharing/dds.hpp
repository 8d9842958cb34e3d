// Cyclone DDS with owning handles: entities are deleted with their owners, errors are thrown.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "haptics/sharing/network.hpp"

namespace palpate::sharing {

/// Throws NetworkError if `result` is an error of DDS; otherwise returns it.
dds_return_t checked(dds_return_t result, const char* what);

/// Owns an entity of DDS.
class Entity {
 public:
  Entity() = default;
  Entity(dds_return_t made, const char* what) : handle_(checked(made, what)) {}
  ~Entity() { reset(); }
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    if (this != &other) {
      reset();
      handle_ = std::exchange(other.handle_, 0);
    }
    return *this;
  }
  operator dds_entity_t() const { return handle_; }  // NOLINT: passed as its handle to every function of DDS

 private:
  void reset() {
    if (handle_ > 0) dds_delete(handle_);
    handle_ = 0;
  }
  dds_entity_t handle_ = 0;
};

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

/// Reliable; kept for late joiners if `lasting`; in the given partition, unless it is empty.
Qos reliableQos(bool lasting, const std::string& partition = {});
/// Best effort, only the newest sample is kept; in the given partition, unless it is empty.
Qos bestEffortQos(const std::string& partition = {});
// For readers: these bound the samples waiting to be taken, however fast senders are.
/// Last samples of a topic without keys. A client that misses a reply asks again.
Qos keepingLast(Qos qos, std::int32_t samples);
/// Last sample of each instance of a topic with keys; instances beyond the maximum get none.
Qos keepingInstances(Qos qos, std::int32_t instances);

/// Whether programs with keys are on the participant's network, whether or not it can receive from them.
bool seesKeyHolders(dds_entity_t participant);

/// A participant on the given network with its keys. All participants of a process on one DDS domain share one network
/// and one set of keys. Throws UsageError if they differ, FileError and NetworkError for faulty keys.
class Participant {
 public:
  explicit Participant(const NetworkConfig& network, Qos qos = {});
  operator dds_entity_t() const { return participant_; }  // NOLINT: as above

 private:
  struct Domain;
  std::shared_ptr<Domain> domain_;
  Entity participant_;
};

/// Topic of samples of type T, which idlc describes.
template <class T>
class Topic {
 public:
  Topic(dds_entity_t participant, const dds_topic_descriptor_t& type, const std::string& name)
      : topic_(dds_create_topic(participant, &type, name.c_str(), nullptr, nullptr), "a topic") {}
  /// Readers created from now on receive only samples that pass `lets`; the others take no room in them. `of` must
  /// outlive the readers.
  void letThrough(bool (*lets)(const void* sample, void* of), const void* of) const {
    checked(dds_set_topic_filter_and_arg(topic_, lets, const_cast<void*>(of)),
            "a topic");  // NOLINT: DDS only passes it back
  }
  operator dds_entity_t() const { return topic_; }  // NOLINT: as above

 private:
  Entity topic_;
};

/// Lets a sequence of a sample refer to the elements, which must outlive the sample.
template <class Sequence, class Elements>
void give(Sequence& to, Elements&& elements) {
  to._buffer = std::data(elements);
  to._length = to._maximum = static_cast<std::uint32_t>(std::size(elements));
}

template <class T>
class Writer {
 public:
  Writer() = default;
  Writer(dds_entity_t participant, const Topic<T>& topic, const Qos& qos)
      : writer_(dds_create_writer(participant, topic, qos.get(), nullptr), "a writer") {}
  /// False if the network has no room within the writer's timeout.
  bool write(const T& sample) const {
    const dds_return_t result = dds_write(writer_, &sample);
    if (result == DDS_RETCODE_TIMEOUT) return false;
    checked(result, "a sample");
    return true;
  }
  /// The same with a source timestamp (dds_time()).
  void writeAt(const T& sample, dds_time_t moment) const {
    checked(dds_write_ts(writer_, &sample, moment), "a sample");
  }
  operator dds_entity_t() const { return writer_; }  // NOLINT: as above

 private:
  Entity writer_;
};

template <class T>
class Reader {
 public:
  Reader() = default;
  Reader(dds_entity_t participant, const Topic<T>& topic, const Qos& qos)
      : reader_(dds_create_reader(participant, topic, qos.get(), nullptr), "a reader") {}
  /// Reader of a built-in topic of DDS (DDS_BUILTIN_TOPIC_…) of type T.
  Reader(dds_entity_t participant, dds_entity_t builtInTopic)
      : reader_(dds_create_reader(participant, builtInTopic, nullptr, nullptr), "a reader") {}
  /// Passes received samples to `visit`, alone or with DDS's sample info; at most kInTurn at a time, so that other work
  /// gets its turn. Skips samples that only report the end of an instance.
  template <class Visit>
  std::size_t take(Visit&& visit) const {
    return takeWithEnds([&](const T& sample, const dds_sample_info_t& about) {
      if (!about.valid_data) return false;
      if constexpr (std::is_invocable_v<Visit, const T&, const dds_sample_info_t&>)
        visit(sample, about);
      else
        visit(sample);
      return true;
    });
  }
  /// The same including those; only their key is valid. If `visit` returns false, the sample is not counted.
  template <class Visit>
  std::size_t takeWithEnds(Visit&& visit) const {
    constexpr std::uint32_t kAtOnce = 16, kInTurn = 2048;
    std::size_t seen = 0;
    for (std::uint32_t taken = 0; taken < kInTurn; taken += kAtOnce) {
      void* samples[kAtOnce] = {};
      dds_sample_info_t about[kAtOnce];
      const auto count = checked(dds_take(reader_, samples, about, kAtOnce, kAtOnce), "received data");
      struct Loan {
        ~Loan() {
          if (count > 0) dds_return_loan(reader, samples, count);
        }
        dds_entity_t reader;
        void** samples;
        dds_return_t count;
      } const loan{reader_, samples, count};
      for (dds_return_t i = 0; i < count; ++i) {
        const T& sample = *static_cast<const T*>(samples[i]);
        if constexpr (std::is_void_v<std::invoke_result_t<Visit, const T&, const dds_sample_info_t&>>) {
          visit(sample, about[i]);
          ++seen;
        } else {
          seen += visit(sample, about[i]);
        }
      }
      if (count < static_cast<dds_return_t>(kAtOnce)) return seen;
    }
    return seen;
  }
  operator dds_entity_t() const { return reader_; }  // NOLINT: as above

 private:
  Entity reader_;
};

/// Lets another thread wake a ReaderWait.
class WakeUp {
 public:
  explicit WakeUp(dds_entity_t participant) : guard_(dds_create_guardcondition(participant), "a condition") {}
  /// From any thread.
  void call() const { dds_set_guardcondition(guard_, true); }
  /// Resets it: only later calls wake again.
  void take() const {
    bool wasCalled = false;
    dds_take_guardcondition(guard_, &wasCalled);
  }
  operator dds_entity_t() const { return guard_; }  // NOLINT: as above

 private:
  Entity guard_;
};

/// Sleeps until one of its readers has a sample or one of its WakeUps is called.
class ReaderWait {
 public:
  explicit ReaderWait(dds_entity_t participant) : wait_(dds_create_waitset(participant), "a waitset") {}
  void attach(dds_entity_t reader);
  void attach(const WakeUp& wakeUp);
  void sleep(double most_s) const;

 private:
  Entity wait_;
  std::vector<Entity> conditions_;
};

}  // namespace palpate::sharing
