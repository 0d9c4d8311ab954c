// The first use of OpenCL in a process, by many threads at once. A program of its own: nothing comes before.
#include "test.h"

#include <barrier>

namespace {

TEST(FirstUse, ByManyThreads) {
    constexpr int count = 8;
    std::string said[count];
    {
        std::barrier start(count);
        std::vector<std::jthread> threads;
        for (std::string& s : said)
            threads.emplace_back([&] {
                start.arrive_and_wait();
                try {
                    const pellucid::Device device("");
                    const pellucid::Buffer buffer(device, 16);
                    buffer.readAll<int>();
                    if (device.info().index >= pellucid::Device::all().size())
                        s = "a device that is not listed";
                } catch (const pellucid::Error& e) {
                    s = e.what();
                }
            });
    }
    for (const std::string& s : said) EXPECT_EQ(s, "");
}

}  // namespace
