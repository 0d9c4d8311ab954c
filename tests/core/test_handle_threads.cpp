// Handles that many threads make, use, retain and release at a time, rightly and wrongly.
// PELLUCID_STRESS_SECONDS: for how long
// (./run check tsan); 2 by default.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

#include "core/handle_kinds.h"

using handles::Kind;
using handles::kinds;

namespace {

constexpr int threadCount = 6;

std::chrono::steady_clock::time_point deadline(int parts) {
    const char* text = std::getenv("PELLUCID_STRESS_SECONDS");
    return std::chrono::steady_clock::now() +
           std::chrono::milliseconds(long((text ? std::atof(text) : 2) * 1000 / parts));
}

void onThreads(const std::function<void(unsigned)>& work) {
    std::vector<std::jthread> threads;
    for (unsigned t = 0; t < threadCount; ++t) threads.emplace_back([&work, t] { work(t); });
}

// Each place holds a handle. Every thread takes handles out, uses them and puts new ones in. A handle is
// released once, by whoever took it out; all else that is done to it meanwhile may be an error, or not.
TEST(HandleThreads, SharedPlaces) {
    const auto end = deadline(2);
    const size_t types = kinds().size(), each = 3;
    std::vector<std::atomic<void*>> places(types * each);
    for (size_t i = 0; i < places.size(); ++i) places[i] = kinds()[i % types].create();
    std::atomic<uint64_t> right{0}, refused{0}, lost{0};
    onThreads([&](unsigned t) {
        std::mt19937 random(t);
        // Longer where other programs keep the machine busy.
        while (std::chrono::steady_clock::now() < end || (right == 0 && refused < 1000000)) {
            const size_t at = random() % places.size();
            const Kind &kind = kinds()[at % types], &other = kinds()[random() % types];
            void* const h = places[at];
            switch (random() % 8) {
                case 0: {  // replaced: only now released by its one holder
                    void* const old = places[at].exchange(kind.create());
                    if (kind.use(old) != PEL_SUCCESS) ++lost;
                    kind.release(old);
                    break;
                }
                case 1:  // another type's call, or its own
                    other.use(h);
                    if (other.name != kind.name) other.release(h), other.retain(h);
                    break;
                case 2:  // long gone, or never there
                    kind.use(static_cast<char*>(h) + 2 * (random() % 64) - 64);
                    break;
                case 3: {  // one of its own beside
                    void* const own = kind.create();
                    kind.retain(own);
                    kind.release(own);
                    if (kind.use(own) != PEL_SUCCESS) ++lost;
                    kind.release(own);
                    if (kind.use(own) == PEL_SUCCESS) ++lost;
                    break;
                }
                default:
                    ++(kind.use(h) == PEL_SUCCESS ? right : refused);
            }
        }
    });
    EXPECT_EQ(lost, 0u);
    EXPECT_GT(right, 0u);
    for (size_t i = 0; i < places.size(); ++i) {
        EXPECT_EQ(kinds()[i % types].use(places[i]), PEL_SUCCESS) << pelGetErrorMessage();
        kinds()[i % types].release(places[i]);
        EXPECT_NE(kinds()[i % types].use(places[i]), PEL_SUCCESS);
    }
}

// All threads release one handle that was retained once for each of them, and some release it again.
TEST(HandleThreads, OneReleaseTooMany) {
    const auto end = deadline(2);
    while (std::chrono::steady_clock::now() < end)
        for (const Kind& kind : kinds()) {
            void *const h = kind.create(), *const next = kind.create();
            for (int t = 1; t < threadCount; ++t) kind.retain(h);
            onThreads([&](unsigned t) {
                EXPECT_EQ(kind.use(h), PEL_SUCCESS);
                kind.release(h);
                if (t % 2) kind.use(h);
            });
            EXPECT_NE(kind.use(h), PEL_SUCCESS);
            void* const after = kind.create();  // where the other was
            onThreads([&](unsigned) { kind.release(h); });
            EXPECT_EQ(kind.use(next), PEL_SUCCESS);
            EXPECT_EQ(kind.use(after), PEL_SUCCESS);
            kind.release(next);
            kind.release(after);
        }
}

}  // namespace
