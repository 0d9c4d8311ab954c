#pragma once
#include <functional>
#include <thread>
#include <vector>

// work(0), work(1), ... at a time, each on a thread of its own.
inline void onThreads(int count, const std::function<void(int)>& work) {
    std::vector<std::jthread> threads;
    for (int t = 0; t < count; ++t) threads.emplace_back([&work, t] { work(t); });
}
