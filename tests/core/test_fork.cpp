// A fork of a process that uses OpenCL has the drivers' locks without their threads: calls fail at once.
#include "core/handle_kinds.h"
#include "core/in_fork.h"

using handles::kinds;

namespace {

bool saysSo(PelError code) {
    return code == PEL_ERROR_INVALID_STATE && std::strstr(pelGetErrorMessage(), "fork");
}

// First of all: nothing has used OpenCL yet.
TEST(Fork, BeforeTheFirstUseItIsAProcessLikeOthers) {
    EXPECT_EQ(inFork([] {
                  const pellucid::Device device("");
                  return pellucid::Buffer(device, std::vector<int>{3}).readAll<int>()[0];
              }),
              3);
}

TEST(Fork, EveryCallIsAnError) {
    std::vector<void*> made;
    for (const handles::Kind& kind : kinds()) made.push_back(kind.create());
    EXPECT_EQ(inFork([&] {
                  uint32_t count = 0;
                  PelDevice device = nullptr;
                  if (!saysSo(pelDeviceCount(&count)) || !saysSo(pelDeviceCreate("", &device))) return 1;
                  for (size_t i = 0; i < made.size(); ++i)
                      if (!saysSo(kinds()[i].use(made[i]))) return 2;
                  // Destructors run in forks, too: nothing may wait there.
                  for (size_t i = 0; i < made.size(); ++i)
                      kinds()[i].retain(made[i]), kinds()[i].release(made[i]), kinds()[i].release(made[i]);
                  return 0;
              }),
              0);
    for (size_t i = 0; i < made.size(); ++i) {
        EXPECT_EQ(kinds()[i].use(made[i]), PEL_SUCCESS) << "in the parent all is as it was";
        kinds()[i].release(made[i]);
    }
}

TEST(Fork, ItCanEnd) {
    const pellucid::Device device("");
    EXPECT_EQ(inFork([]() -> int { std::exit(5); }), 5);
}

// While other threads are in the middle of calls, including the error callback.
TEST(Fork, InTheMiddleOfThings) {
    pelSetErrorCallback([](void*, PelError, const char*) {}, nullptr);
    std::atomic<bool> done{false};
    std::vector<std::jthread> threads;
    for (int t = 0; t < 3; ++t)
        threads.emplace_back([&] {
            while (!done)
                for (const handles::Kind& kind : kinds()) {
                    void* const h = kind.create();
                    kind.release(h);
                    kind.use(h);
                }
        });
    for (int i = 0; i < 20; ++i)
        EXPECT_EQ(inFork([&] {
                      uint32_t count = 0;
                      pelSetErrorCallback([](void*, PelError, const char*) {}, nullptr);
                      return saysSo(pelDeviceCount(&count)) && saysSo(pelDeviceFinish(device().get())) ? 0
                                                                                                       : 1;
                  }),
                  0);
    done = true;
    threads.clear();
    pelSetErrorCallback(nullptr, nullptr);
}

}  // namespace
