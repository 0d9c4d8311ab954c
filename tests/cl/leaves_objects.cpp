// Leaks one buffer and one event; if named `profile`, one profile, which is not an OpenCL object. The leak
// checks must fail this program, which proves that they find leaks.
#include <cstring>
#include <pellucid/pellucid.hpp>

#include "cl/cl_spy.h"

int main(int argc, char** argv) {
    spy::counts();  // so that it is loaded
    if (argc > 1 && std::strcmp(argv[1], "profile") == 0) {
        PelProfile profile = nullptr;
        pellucid::check(pelProfileCreateSkin(&profile));
        return 0;
    }
    const pellucid::Device device("");
    PelBuffer buffer = nullptr;
    PelEvent done = nullptr;
    const PelSubmit submit{nullptr, 0, &done};
    pellucid::check(pelBufferCreate(device.get(), 64, nullptr, &buffer));
    pellucid::check(pelBufferRead(buffer, 0, 0, nullptr, &submit));
}
