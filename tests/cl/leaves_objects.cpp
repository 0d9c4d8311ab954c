// Leaves one buffer and one event behind. The spy is to fail it: a watch that sees nothing passes everything.
#include <pellucid/pellucid.hpp>

int main() {
    const pellucid::Device device("");
    PelBuffer buffer = nullptr;
    PelEvent done = nullptr;
    const PelSubmit submit{nullptr, 0, &done};
    pellucid::check(pelBufferCreate(device.get(), 64, nullptr, &buffer));
    pellucid::check(pelBufferRead(buffer, 0, 0, nullptr, &submit));
}
