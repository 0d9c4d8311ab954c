#include "core/object.h"

#include <mutex>
#include <unordered_map>

namespace pel {
namespace {

struct Registry {
    std::mutex mutex;
    std::unordered_map<const void*, Kind> live;
};

// Never destroyed: handles may be released by other static objects on the way out.
Registry& registry() {
    static Registry* r = new Registry;
    return *r;
}

}  // namespace

const char* kindName(Kind kind) {
    switch (kind) {
        case Kind::device:
            return "PelDevice";
        case Kind::event:
            return "PelEvent";
        case Kind::buffer:
            return "PelBuffer";
        case Kind::meshTopology:
            return "PelMeshTopology";
        case Kind::liveMesh:
            return "PelLiveMesh";
        case Kind::lut:
            return "PelLut";
        case Kind::shader:
            return "PelShader";
        case Kind::profile:
            return "PelProfile";
    }
    return "object";
}

Object::Object(Kind kind) {
    std::lock_guard lock(registry().mutex);
    registry().live.emplace(this, kind);
}

Object::~Object() {
    std::lock_guard lock(registry().mutex);
    registry().live.erase(this);
}

Object& checkedObject(void* handle, Kind kind) {
    if (!handle) invalidArgument("a ", kindName(kind), " is needed here, not NULL");
    std::lock_guard lock(registry().mutex);
    const auto found = registry().live.find(handle);
    if (found == registry().live.end())
        invalidArgument("this is no ", kindName(kind), ", or one that was released already");
    if (found->second != kind)
        invalidArgument("a ", kindName(kind), " is needed here, not a ", kindName(found->second));
    return *static_cast<Object*>(handle);
}

Object* liveObject(void* handle) {
    std::lock_guard lock(registry().mutex);
    return registry().live.contains(handle) ? static_cast<Object*>(handle) : nullptr;
}

}  // namespace pel
