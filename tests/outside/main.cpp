#include <cstdio>
#include <pellucid/pellucid.hpp>

int main() {
    const pellucid::Device device;
    std::printf("%s\n", device.info().name);
}
