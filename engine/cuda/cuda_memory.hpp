// RAII owners of CUDA runtime resources. Managed memory is never used: pages that migrate between host and device would
// cause page faults in the tick.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/cuda/cuda_check.hpp"

namespace palpate::cu {

/// A stream: commands in order, independent of every other stream (including the legacy default stream: a kernel that
/// never ends must not block those).
class Stream {
 public:
  Stream() { checkCuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "creating a stream"); }
  ~Stream() { cudaStreamDestroy(stream_); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  cudaStream_t get() const { return stream_; }
  void synchronize(const char* what) const { checkCuda(cudaStreamSynchronize(stream_), what); }
  /// Whether all of its commands have completed. Throws the error of a failed one.
  bool idle(const char* what) const {
    const cudaError_t status = cudaStreamQuery(stream_);
    if (status == cudaErrorNotReady) return false;
    checkCuda(status, what);
    return true;
  }

 private:
  cudaStream_t stream_ = nullptr;
};

/// A point in time on the GPU.
class Event {
 public:
  Event() { checkCuda(cudaEventCreate(&event_), "creating an event"); }
  ~Event() { cudaEventDestroy(event_); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;

  void record(const Stream& stream) { checkCuda(cudaEventRecord(event_, stream.get()), "recording an event"); }
  bool reached(const char* what) const {
    const cudaError_t status = cudaEventQuery(event_);
    if (status == cudaErrorNotReady) return false;
    checkCuda(status, what);
    return true;
  }
  void synchronize(const char* what) const { checkCuda(cudaEventSynchronize(event_), what); }
  /// Requires that both events have been reached.
  double since_us(const Event& start) const {
    float time_ms = 0;
    checkCuda(cudaEventElapsedTime(&time_ms, start.event_, event_), "reading a time");
    return 1e3 * static_cast<double>(time_ms);
  }

 private:
  cudaEvent_t event_ = nullptr;
};

/// `count` values in device memory; allocates at least one, so that an empty cloud has addresses, too.
template <class T>
class DeviceArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  explicit DeviceArray(std::size_t count) : count_(count) {
    void* memory = nullptr;
    checkCuda(cudaMalloc(&memory, sizeof(T) * (count ? count : 1)), "allocating GPU memory");
    data_ = static_cast<T*>(memory);
  }
  ~DeviceArray() { cudaFree(data_); }
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;

  T* data() const { return data_; }
  std::size_t size() const { return count_; }
  void clear(const Stream& stream) {
    checkCuda(cudaMemsetAsync(data_, 0, sizeof(T) * count_, stream.get()), "clearing GPU memory");
  }
  /// Both wait for the stream.
  void upload(std::span<const T> values, const Stream& stream) {
    checkCuda(cudaMemcpyAsync(data_, values.data(), values.size_bytes(), cudaMemcpyHostToDevice, stream.get()),
              "writing to the GPU");
    stream.synchronize("writing to the GPU");
  }
  std::vector<T> download(const Stream& stream) const {
    std::vector<T> values(count_);
    checkCuda(cudaMemcpyAsync(values.data(), data_, sizeof(T) * count_, cudaMemcpyDeviceToHost, stream.get()),
              "reading from the GPU");
    stream.synchronize("reading from the GPU");
    return values;
  }

 private:
  T* data_ = nullptr;
  std::size_t count_;
};

/// One value in pinned host memory that kernels read and write in place.
template <class T>
class MappedValue {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  MappedValue() {
    checkCuda(cudaHostAlloc(&memory_, sizeof(T), cudaHostAllocMapped), "allocating pinned memory");
    host_ = new (memory_) T{};
    void* device = nullptr;
    const cudaError_t status = cudaHostGetDevicePointer(&device, memory_, 0);
    if (status != cudaSuccess) cudaFreeHost(memory_);
    checkCuda(status, "mapping pinned memory");
    device_ = static_cast<T*>(device);
  }
  ~MappedValue() { cudaFreeHost(memory_); }
  MappedValue(const MappedValue&) = delete;
  MappedValue& operator=(const MappedValue&) = delete;

  T& host() const { return *host_; }
  T* device() const { return device_; }

 private:
  void* memory_ = nullptr;
  T* host_ = nullptr;
  T* device_ = nullptr;
};

/// Load and store of the word that marks, on either side, that everything written before it is complete.
inline std::uint32_t loadAcquire(const std::uint32_t& word) {
  return std::atomic_ref(const_cast<std::uint32_t&>(word)).load(std::memory_order_acquire);
}
inline void storeRelease(std::uint32_t& word, std::uint32_t value) {
  std::atomic_ref(word).store(value, std::memory_order_release);
}

/// Commands recorded once and launched as one.
class Graph {
 public:
  /// `commands()` submits the graph's commands to `stream`, and must not wait. The capture mode is relaxed, because a
  /// kernel that is used for the first time is loaded then.
  template <class Commands>
  Graph(const Stream& stream, Commands&& commands) {
    checkCuda(cudaStreamBeginCapture(stream.get(), cudaStreamCaptureModeRelaxed), "recording a graph");
    cudaGraph_t graph = nullptr;
    try {
      commands();
    } catch (...) {
      cudaStreamEndCapture(stream.get(), &graph);
      if (graph) cudaGraphDestroy(graph);
      cudaGetLastError();
      throw;
    }
    checkCuda(cudaStreamEndCapture(stream.get(), &graph), "recording a graph");
    const cudaError_t status = cudaGraphInstantiate(&executable_, graph, 0);
    cudaGraphDestroy(graph);
    checkCuda(status, "preparing a graph");
    const cudaError_t uploaded = cudaGraphUpload(executable_, stream.get());
    if (uploaded != cudaSuccess) cudaGraphExecDestroy(executable_);
    checkCuda(uploaded, "preparing a graph");
  }
  ~Graph() { cudaGraphExecDestroy(executable_); }
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  void launch(const Stream& stream) const {
    checkCuda(cudaGraphLaunch(executable_, stream.get()), "launching a graph");
  }

 private:
  cudaGraphExec_t executable_ = nullptr;
};

}  // namespace palpate::cu
