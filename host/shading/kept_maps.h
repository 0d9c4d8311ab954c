// Results that passes compute only from shadow maps: kept while PelLight.shadowMapVersion is unchanged, and
// shared by the shaders of a device, such as those of two eyes.
#pragma once
#include "shading/pass.h"

namespace pel {

// All inputs of such a result.
class MapsKey {
  public:
    explicit MapsKey(const char* pass) : bytes_(pass) {}
    void add(const void* bytes, size_t count) { bytes_.append(static_cast<const char*>(bytes), count); }
    void addMap(const ShaderLight& light, uint32_t cascade);
    bool rests() const { return rests_; }
    const std::string& bytes() const { return bytes_; }
    std::vector<Ref<Buffer>> takeMaps() { return std::move(maps_); }

  private:
    std::string bytes_;
    std::vector<Ref<Buffer>> maps_;
    bool rests_ = true;
};

// A pass's buffer of results.
class KeptMaps {
  public:
    void allocate(const Ref<Device>& device, MapsKey key, size_t bytes);
    const cl::Memory& memory() const { return shared_ ? shared_->buffer->memory() : own_->memory(); }
    // Bytes of this shader; 0 if another shader made the shared results before it.
    size_t bytes() const {
        return shared_ ? first_ ? shared_->buffer->bytes() : 0 : own_ ? own_->bytes() : 0;
    }
    // Whether others may use the results, which therefore must not depend on the tiles of a view.
    bool isShared() const { return bool(shared_); }
    bool made() const;
    // After the launches of `work` that make the results.
    void setMade(const PassWork& work);

  private:
    struct Shared {
        Ref<Buffer> buffer;
        std::vector<Ref<Buffer>> maps;  // so that no other buffer gets their address
        std::mutex mutex;
        bool made = false;
        cl::Event last;  // of the launches, until it has run
    };
    Ref<Buffer> own_;
    std::shared_ptr<Shared> shared_;
    std::string key_;
    bool first_ = false;
};

}  // namespace pel
