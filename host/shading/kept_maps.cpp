#include "shading/kept_maps.h"

#include "shading/shading_constants.h"

namespace pel {

void MapsKey::addMap(const ShaderLight& light, uint32_t cascade) {
    const PelLight& l = light.params;
    const ShadowCascade from = shadowCascade(light, cascade);
    rests_ &= l.shadowMapVersion != 0;
    maps_.push_back(from.map->buffer);
    const Buffer* buffer = from.map->buffer.get();
    const PelShadeImage image = describeImage(*from.map);
    add(&buffer, sizeof buffer);
    add(&image, sizeof image);
    add(&from.map->format, sizeof from.map->format);
    add(&l.shadowMapVersion, sizeof l.shadowMapVersion);
    add(from.worldToShadow, sizeof *from.worldToShadow);
    for (const float f : {from.depthRange, l.shadowDepthA, l.shadowDepthB, l.shadowExponent})
        add(&f, sizeof f);
    for (const int choice : {int(l.shadowProjection), int(l.shadowContent)}) add(&choice, sizeof choice);
}

void KeptMaps::allocate(const Ref<Device>& device, MapsKey key, size_t bytes) {
    if (!key.rests() || CountedRun::on()) {  // results that are only counted must not be shared
        shared_.reset();
        resize(own_, device, bytes);
        return;
    }
    own_ = Ref<Buffer>();
    if (shared_ && key_ == key.bytes()) return;
    shared_.reset();
    key_ = key.bytes();
    first_ = false;
    shared_ = device->shared<Shared>(key_, [&] {
        auto made = std::make_shared<Shared>();
        made->buffer = Buffer::create(device, bytes, nullptr);
        made->maps = key.takeMaps();
        first_ = true;
        return made;
    });
}

bool KeptMaps::made() const {
    if (!shared_) return false;
    const std::lock_guard lock(shared_->mutex);
    if (!shared_->made || !shared_->last) return shared_->made;
    const cl_int status = cl::info<cl_int>(shared_->last.get(), CL_EVENT_COMMAND_EXECUTION_STATUS);
    if (status < 0) shared_->made = false;  // a command that it waited for failed
    if (status <= CL_COMPLETE) shared_->last = cl::Event();
    return shared_->made;
}

void KeptMaps::setMade(const PassWork& work) {
    if (!shared_ || work.codeAlone || work.events.empty()) return;
    const std::lock_guard lock(shared_->mutex);
    shared_->made = true;
    shared_->last = work.events.back();
}

}  // namespace pel
