// Memory that host and device share: the library's own, the caller's memory in place, or its cl_mem.
#pragma once
#include "core/device.h"

namespace pel {

class Buffer final : public Object {
  public:
    static constexpr Kind kind = Kind::buffer;
    static Ref<Buffer> create(Ref<Device> device, size_t bytes, const void* initial);
    static Ref<Buffer> createFromHost(Ref<Device> device, void* memory, size_t bytes);
    static Ref<Buffer> createFromCl(Ref<Device> device, cl_mem memory);

    Device& device() const { return *device_; }
    size_t bytes() const { return bytes_; }
    const cl::Memory& memory() const { return memory_; }
    // Whether it is the copy of a texture.
    bool ofTexture() const { return bool(texture_); }
    // Enqueues the copy from the texture, or back to it.
    void copyTexture(bool back) const;
    // Whether the copy already has this version of the texture's content, because the previous call had the
    // same number. 0: always a new version.
    bool hasVersion(uint32_t version) { return version_.exchange(version) == version && version; }

    // Where byte 0 is. Two buffers with the same `whole` are in the same memory; NULL means host memory.
    struct Place {
        cl_mem whole = nullptr;
        uint64_t offset = 0;
    };
    const Place& place() const { return place_; }

    // Throws unless [offset, offset + bytes) lies inside.
    void checkRange(uint64_t offset, uint64_t bytes, const char* what) const;
    void* map();
    void unmap();

    Buffer(Ref<Device> device, cl::Memory memory, size_t bytes);

  private:
    ~Buffer() override;
    Ref<Device> device_;
    cl::Memory memory_;
    cl::Memory texture_;                // that it is a copy of
    std::array<size_t, 3> texels_{};    // its size
    std::atomic<uint32_t> version_{0};  // of the last copy
    size_t bytes_;
    Place place_;
    std::mutex mutex_;
    void* mapped_ = nullptr;
    uint32_t mapCount_ = 0;
};

}  // namespace pel
