#include "core/object.h"

namespace pel {
namespace {

std::atomic<uint64_t> objects{0};

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
        case Kind::scatter:
            return "PelScatter";
        case Kind::textureScatter:
            return "PelTextureScatter";
    }
    return "object";
}

Object::Object(Kind kind) : kind_(kind) {
    objects.fetch_add(1, std::memory_order_relaxed);
}

Object::~Object() {
    objects.fetch_sub(1, std::memory_order_relaxed);
}

uint64_t Object::alive() {
    return objects.load(std::memory_order_relaxed);
}

}  // namespace pel
