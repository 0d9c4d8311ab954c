// Long work of the host on all processors.
#pragma once
#include <algorithm>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace pel {

// Parts that [0, count) is cut into: one per processor, but none below `least` elements; at least 1.
inline size_t partsOf(size_t count, size_t least) {
    const size_t processors = std::thread::hardware_concurrency();
    return std::max<size_t>(1, std::min(processors, count / least));
}

// Calls work(part, begin, end) for each part, side by side. Throws what one throws after all have ended.
template <class Work>
void inParts(size_t count, size_t parts, const Work& work) {
    std::mutex mutex;
    std::exception_ptr failed;
    const auto run = [&](size_t part) {
        try {
            work(part, count * part / parts, count * (part + 1) / parts);
        } catch (...) {
            const std::lock_guard lock(mutex);
            failed = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> helpers;
        for (size_t part = 1; part < parts; ++part) {
            try {
                helpers.emplace_back(run, part);
            } catch (const std::system_error&) {  // no more threads for this process
                run(part);
            }
        }
        run(0);
    }
    if (failed) std::rethrow_exception(failed);
}

}  // namespace pel
