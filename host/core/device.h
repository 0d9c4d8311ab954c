// One OpenCL device with its context, queue, programs and counters.
#pragma once
#include "cl/launch.h"
#include "cl/program_cache.h"
#include "core/object.h"
#include "tuning/launch_sizes.h"

namespace pel {

// While one exists, this thread's allocations are only counted: buffers are tiny, and nothing is sent.
class CountedRun {
  public:
    CountedRun() { on_ = true; }
    ~CountedRun() { on_ = false; }
    static bool on() { return on_; }

  private:
    inline static thread_local bool on_ = false;
};

class Device final : public Object {
  public:
    static constexpr Kind kind = Kind::device;

    static Ref<Device> create(const PelDeviceDesc& desc);
    static Ref<Device> createFromCl(cl_context context, cl_device_id device, cl_command_queue queue);

    const PelDeviceInfo& info() const { return info_; }
    const LaunchPolicy& policy() const { return launches_.policy; }
    cl_context context() const { return context_.get(); }
    cl_device_id id() const { return id_; }
    cl_command_queue queue() const { return queue_.get(); }
    cl::ProgramCache& programs() { return programs_; }

    // Enqueues on the in-order queue, or on another one of this context, and counts the launch. Returns its
    // event (empty for an empty range).
    cl::Event launch(cl::Launch& launch, const cl::Range& range, cl_command_queue queue = nullptr);
    // The launch of a kernel with these arguments, whose event goes to `events`.
    template <class... Values>
    void launch(std::vector<cl::Event>& events, const cl::Program& program, const char* kernel,
                const cl::Range& range, const Values&... values) {
        cl::Launch one(program, kernel, values...);
        events.push_back(launch(one, range));
    }
    // For work that a call waits for: the device's own queue may wait for an event of the caller.
    cl_command_queue sideQueue();

    // Device memory: a copy of `initial`, else zeros if asked for.
    cl::Memory allocate(size_t bytes, const void* initial = nullptr, bool zeros = false);
    cl::Memory allocateZeros(size_t bytes) { return allocate(bytes, nullptr, true); }
    // A copy of all values; no memory for none.
    template <class T>
    cl::Memory upload(const std::vector<T>& values) {
        return values.empty() ? cl::Memory() : allocate(values.size() * sizeof(T), values.data());
    }
    // Constants that depend on `key` alone. The first call makes them; a few are kept if they are small.
    template <class Make>
    cl::Memory constants(const std::string& key, const Make& make) {
        {
            const std::lock_guard lock(mutex_);
            if (const auto found = constants_.find(key); found != constants_.end()) return found->second;
        }
        const auto values = make();
        const cl::Memory memory = upload(values);
        if (values.size() * sizeof values[0] > 1 << 16) return memory;
        const std::lock_guard lock(mutex_);
        if (constants_.size() == 32) constants_.clear();
        return constants_.insert_or_assign(key, memory).first->second;
    }
    // Data that several objects share and that depends only on `key`. It is released with the last of them.
    template <class T, class Make>
    std::shared_ptr<T> shared(const std::string& key, const Make& make) {
        const std::lock_guard lock(sharedMutex_);
        std::erase_if(shared_, [](const auto& entry) { return entry.second.expired(); });
        if (const auto found = shared_.find(key); found != shared_.end())
            if (auto held = found->second.lock()) return std::static_pointer_cast<T>(held);
        std::shared_ptr<T> made = make();
        shared_[key] = made;
        return made;
    }
    void countTransfer(size_t toDevice, size_t toHost);
    // `destination` and `source` are not NULL. Blocking calls return when the bytes are copied.
    void read(cl_mem memory, size_t offset, size_t bytes, void* destination, bool blocking,
              cl_command_queue queue = nullptr);
    void write(cl_mem memory, size_t offset, size_t bytes, const void* source, bool blocking,
               cl_command_queue queue = nullptr);
    // Enqueues the write of these bytes to the beginning of the memory.
    void writeLater(cl_mem memory, std::vector<unsigned char> bytes);
    // Reads the first bytes at once, on another queue. No queued command may use the memory.
    void readOnSideQueue(cl_mem memory, size_t bytes, void* destination) {
        exchange(memory, bytes, nullptr, destination);
    }
    void writeAside(cl_mem memory, size_t bytes, const void* source) {
        exchange(memory, bytes, source, nullptr);
    }

    // Enqueues a copy.
    void copy(cl_mem from, size_t fromOffset, cl_mem to, size_t offset, size_t bytes);
    // Enqueues: fills `bytes`, a multiple of 4, from `offset` on with copies of `word`.
    void fill(cl_mem memory, size_t offset, size_t bytes, uint32_t word);

    void finish() { cl::check(clFinish(queue_.get()), "clFinish"); }
    PelDeviceStats stats();

    bool hasProgress();
    void setProgress(PelProgressCallback callback, void* user);
    // Reports progress of long work to the caller. Throws PEL_ERROR_CANCELLED if the callback cancels.
    void progress(double fraction, const char* what);

    Device(cl::Context context, cl_device_id id, cl::Queue queue, const PelDeviceInfo& info);

  private:
    ~Device() override;
    void foldPending();
    cl::Memory hostsMemory(size_t bytes) const;
    void exchange(cl_mem memory, size_t bytes, const void* source, void* destination);

    cl::Context context_;
    cl_device_id id_;
    cl::Queue queue_;
    PelDeviceInfo info_;
    LaunchRule launches_;
    cl::ProgramCache programs_;
    bool profiling_;
    PelAllocateCallback allocate_ = nullptr;
    void* allocateUser_ = nullptr;

    std::mutex sharedMutex_;  // guards the next
    std::map<std::string, std::weak_ptr<void>> shared_;
    std::mutex mutex_;  // guards the rest
    std::map<std::string, cl::Memory> constants_;
    // Launches that may still be queued. They keep kernels alive, because NVIDIA's driver (580) still uses a
    // kernel that is released before its launch starts.
    struct Pending {
        cl::Event event;
        cl::Kernel kernel;
    };
    std::vector<Pending> pending_;
    struct Write {
        cl::Event event;
        std::vector<unsigned char> bytes;
    };
    std::vector<Write> writes_;  // that may be queued still
    cl::Queue sideQueue_;
    PelDeviceStats stats_;
    PelProgressCallback progress_ = nullptr;
    void* progressUser_ = nullptr;
};

// Device time of finished commands, in milliseconds; 0 without profiling.
double eventMilliseconds(const cl::Event& event);

}  // namespace pel
