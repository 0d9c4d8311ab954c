#include "core/device.h"

#include <cstdlib>

#include "cl/host_memory.h"
#include "cl/machine.h"
#include "cl/platform.h"
#include "core/error_log.h"

namespace pel {

static bool wantsProfiling(const PelDeviceDesc& desc) {
    if (desc.profiling > 2)
        invalidArgument("PelDeviceDesc.profiling is ", desc.profiling, "; it must be 0, 1 or 2");
    if (desc.profiling < 2) return desc.profiling == 1;
    const char* const variable = std::getenv("PELLUCID_PROFILING");
    const std::string_view value = variable ? variable : "";
    if (!value.empty() && value != "0" && value != "1")
        invalidArgument("PELLUCID_PROFILING is \"", value, "\"; it must be 0 or 1");
    return value != "0";
}

static cl::Defines definesFor(cl_device_id id, const PelDeviceInfo& info, const LaunchPolicy& policy) {
    cl::Defines all{{"PEL_WIDTH", info.mathWidth}, {"PEL_GROUP", policy.texels}};
    if (cl::infoString(id, CL_DEVICE_EXTENSIONS).find("cl_nv_compiler_options") != std::string::npos)
        all.emplace("PEL_REGISTERS", nvidiaRegisters);
    return all;
}

Ref<Device> Device::create(const PelDeviceDesc& desc) {
    const bool profiling = wantsProfiling(desc);
    const uint32_t index = cl::selectDevice(desc.selector);
    cl_device_id id = cl::allDevices().at(index);
    cl_int code = CL_SUCCESS;
    cl::Context context(clCreateContext(nullptr, 1, &id, nullptr, nullptr, &code));
    cl::check(code, "clCreateContext");
    cl::Queue queue(
        clCreateCommandQueue(context.get(), id, profiling ? CL_QUEUE_PROFILING_ENABLE : 0, &code));
    cl::check(code, "clCreateCommandQueue");
    Ref<Device> device = make<Device>(context, id, queue, cl::describe(id, index));
    device->allocate_ = desc.allocate, device->allocateUser_ = desc.allocateUser;
    return device;
}

Ref<Device> Device::createFromCl(cl_context context, cl_device_id id, cl_command_queue queue) {
    if (!context || !id || !queue)
        invalidArgument(
            "a device from the caller's OpenCL objects needs all of cl_context, cl_device_id and "
            "cl_command_queue");
    cl::claimProcess();
    if (cl::info<cl_context>(queue, CL_QUEUE_CONTEXT) != context)
        invalidArgument("the cl_command_queue belongs to another cl_context than the one given");
    if (cl::info<cl_device_id>(queue, CL_QUEUE_DEVICE) != id)
        invalidArgument("the cl_command_queue belongs to another cl_device_id than the one given");
    if (cl::info<cl_command_queue_properties>(queue, CL_QUEUE_PROPERTIES) &
        CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE)
        invalidArgument("the cl_command_queue is out of order; an in-order queue is needed");
    return make<Device>(cl::Context::retained(context), id, cl::Queue::retained(queue),
                        cl::describe(id, UINT32_MAX));
}

Device::Device(cl::Context context, cl_device_id id, cl::Queue queue, const PelDeviceInfo& info)
    : Object(kind),
      context_(context),
      id_(id),
      queue_(std::move(queue)),
      info_(info),
      launches_(launchRule(info)),
      programs_(std::move(context), id, definesFor(id, info, launches_.policy)),
      profiling_(cl::info<cl_command_queue_properties>(queue_.get(), CL_QUEUE_PROPERTIES) &
                 CL_QUEUE_PROFILING_ENABLE),
      stats_(pelDeviceStatsDefaults()) {
    warn(launches_.warning);
}

Device::~Device() {
    clFinish(queue_.get());
}

cl_command_queue Device::sideQueue() {
    const std::lock_guard lock(mutex_);
    if (!sideQueue_) {
        cl_int code = CL_SUCCESS;
        sideQueue_ = cl::Queue(
            clCreateCommandQueue(context_.get(), id_, profiling_ ? CL_QUEUE_PROFILING_ENABLE : 0, &code));
        cl::check(code, "clCreateCommandQueue");
    }
    return sideQueue_.get();
}

cl::Event Device::launch(cl::Launch& launch, const cl::Range& range, cl_command_queue queue) {
    cl::Event event = launch.enqueue(queue ? queue : queue_.get(), range);
    if (!event) return event;
    std::lock_guard lock(mutex_);
    ++stats_.launches;
    pending_.push_back({event, launch.kernel()});
    if (pending_.size() > 512) foldPending();
    return event;
}

cl::Memory Device::allocate(size_t bytes, const void* initial, bool zeros) {
    if (bytes > info_.maxAllocationBytes)
        fail(PEL_ERROR_OUT_OF_MEMORY, bytes, " bytes are more than this device allocates at once (",
             info_.maxAllocationBytes, ")");
    if (CountedRun::on()) {
        cl_int code = CL_SUCCESS;
        cl::Memory tiny(clCreateBuffer(context_.get(), CL_MEM_READ_WRITE, 16, nullptr, &code));
        cl::check(code, "clCreateBuffer");
        return tiny;
    }
    cl::Memory memory = allocate_ ? hostsMemory(bytes) : cl::Memory();
    if (memory) {
        if (initial) writeAside(memory.get(), bytes, initial);
    } else if (info_.type == PEL_DEVICE_CPU && info_.sharedMemory) {
        memory = cl::createInHostMemory(context_.get(), bytes, initial, zeros);
        zeros = zeros && !memory;
    }
    if (!memory) {
        cl_int code = CL_SUCCESS;
        const cl_mem_flags flags = CL_MEM_READ_WRITE | (initial ? CL_MEM_COPY_HOST_PTR : 0);
        memory = cl::Memory(clCreateBuffer(context_.get(), flags, bytes, const_cast<void*>(initial), &code));
        if (code != CL_SUCCESS) cl::check(code, text("clCreateBuffer(", bytes, " bytes)").c_str());
    }
    if (const cl_uchar zero = 0; zeros)
        cl::check(clEnqueueFillBuffer(queue(), memory.get(), &zero, 1, 0, bytes, 0, nullptr, nullptr),
                  "clEnqueueFillBuffer");
    std::lock_guard lock(mutex_);
    stats_.bytesAllocated += bytes;
    if (initial) stats_.bytesToDevice += bytes;
    return memory;
}

cl::Memory Device::hostsMemory(size_t bytes) const {
    cl::Memory memory(cl_mem(allocate_(allocateUser_, context_.get(), bytes)));
    if (!memory) fail(PEL_ERROR_OUT_OF_MEMORY, "PelDeviceDesc.allocate could not provide ", bytes, " bytes");
    if (const size_t size = cl::info<size_t>(memory.get(), CL_MEM_SIZE); size < bytes)
        invalidArgument("PelDeviceDesc.allocate gave a buffer of ", size, " bytes; ", bytes, " are needed");
    return memory;
}

void Device::countTransfer(size_t toDevice, size_t toHost) {
    std::lock_guard lock(mutex_);
    stats_.bytesToDevice += toDevice;
    stats_.bytesToHost += toHost;
}

void Device::read(cl_mem memory, size_t offset, size_t bytes, void* destination, bool blocking,
                  cl_command_queue queue) {
    cl::check(clEnqueueReadBuffer(queue ? queue : queue_.get(), memory, blocking, offset, bytes, destination,
                                  0, nullptr, nullptr),
              "clEnqueueReadBuffer");
    countTransfer(0, bytes);
}

void Device::write(cl_mem memory, size_t offset, size_t bytes, const void* source, bool blocking,
                   cl_command_queue queue) {
    if (CountedRun::on()) return;
    cl::check(clEnqueueWriteBuffer(queue ? queue : queue_.get(), memory, blocking, offset, bytes, source, 0,
                                   nullptr, nullptr),
              "clEnqueueWriteBuffer");
    countTransfer(bytes, 0);
}

void Device::writeLater(cl_mem memory, std::vector<unsigned char> bytes) {
    if (CountedRun::on()) return;
    cl_event written = nullptr;
    cl::check(
        clEnqueueWriteBuffer(queue(), memory, CL_FALSE, 0, bytes.size(), bytes.data(), 0, nullptr, &written),
        "clEnqueueWriteBuffer");
    countTransfer(bytes.size(), 0);
    const std::lock_guard lock(mutex_);
    // Not by a callback of the event: those run on the driver's threads.
    std::erase_if(writes_, [](const Write& write) {
        return cl::info<cl_int>(write.event.get(), CL_EVENT_COMMAND_EXECUTION_STATUS) <= CL_COMPLETE;
    });
    writes_.push_back({cl::Event(written), std::move(bytes)});
}

void Device::exchange(cl_mem memory, size_t bytes, const void* source, void* destination) {
    if (bytes == 0 || CountedRun::on()) return;
    const cl_command_queue queue = sideQueue();
    if (!info_.sharedMemory)
        return source ? write(memory, 0, bytes, source, true, queue)
                      : read(memory, 0, bytes, destination, true, queue);
    // One at a time: PoCL confuses mappings of one buffer that several threads make.
    static std::mutex mapping;
    const std::lock_guard lock(mapping);
    cl_int code = CL_SUCCESS;
    void* const at = clEnqueueMapBuffer(queue, memory, CL_TRUE, source ? CL_MAP_WRITE : CL_MAP_READ, 0, bytes,
                                        0, nullptr, nullptr, &code);
    cl::check(code, "clEnqueueMapBuffer");
    std::memcpy(source ? at : destination, source ? source : at, bytes);
    cl::check(clEnqueueUnmapMemObject(queue, memory, at, 0, nullptr, nullptr), "clEnqueueUnmapMemObject");
    cl::check(clFinish(queue), "clFinish");
}

void Device::copy(cl_mem from, size_t fromOffset, cl_mem to, size_t offset, size_t bytes) {
    if (CountedRun::on()) return;
    cl::check(clEnqueueCopyBuffer(queue(), from, to, fromOffset, offset, bytes, 0, nullptr, nullptr),
              "clEnqueueCopyBuffer");
}

void Device::fill(cl_mem memory, size_t offset, size_t bytes, uint32_t word) {
    if (CountedRun::on()) return;
    cl::check(clEnqueueFillBuffer(queue(), memory, &word, sizeof word, offset, bytes, 0, nullptr, nullptr),
              "clEnqueueFillBuffer");
}

PelDeviceStats Device::stats() {
    finish();
    std::lock_guard lock(mutex_);
    foldPending();  // except launches that other threads submitted meanwhile
    PelDeviceStats result = stats_;
    const cl::ProgramCache::Counts programs = programs_.counts();
    result.programsBuilt = programs.built;
    result.buildMilliseconds = programs.milliseconds;
    result.programsLoaded = programs.loaded;
    result.programsStored = programs.stored;
    return result;
}

// Adds the time of finished launches to the total and forgets them. Unfinished ones are kept.
void Device::foldPending() {
    std::erase_if(pending_, [&](const Pending& launched) {
        const cl_event event = launched.event.get();
        if (cl::info<cl_int>(event, CL_EVENT_COMMAND_EXECUTION_STATUS) > CL_COMPLETE) return false;
        stats_.kernelMilliseconds += eventMilliseconds(launched.event);
        return true;
    });
}

void Device::setProgress(PelProgressCallback callback, void* user) {
    std::lock_guard lock(mutex_);
    progress_ = callback;
    progressUser_ = user;
}

bool Device::hasProgress() {
    std::lock_guard lock(mutex_);
    return progress_ != nullptr;
}

void Device::progress(double fraction, const char* what) {
    PelProgressCallback callback;
    void* user;
    {
        std::lock_guard lock(mutex_);
        callback = progress_;
        user = progressUser_;
    }
    if (callback && !callback(user, fraction, what))
        fail(PEL_ERROR_CANCELLED, "cancelled by the caller during: ", what);
}

double eventMilliseconds(const cl::Event& event) {
    cl_ulong start = 0, end = 0;
    const auto got = [&](cl_profiling_info what, cl_ulong& time) {
        return clGetEventProfilingInfo(event.get(), what, sizeof time, &time, nullptr) == CL_SUCCESS;
    };
    const bool known = event && got(CL_PROFILING_COMMAND_START, start) && got(CL_PROFILING_COMMAND_END, end);
    return known && end >= start ? double(end - start) * 1e-6 : 0;
}

}  // namespace pel
