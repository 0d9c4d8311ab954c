#include "build_helpers.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace pellucid::cli {
namespace fs = std::filesystem;
namespace {

constexpr auto moment = std::chrono::milliseconds(300);  // loading programs from a cache takes less
constexpr unsigned mostHelpers = 3;                      // each takes about 200 MB
constexpr const char* variable = "PELLUCID_BUILD_SHARE";

}  // namespace

BuildHelpers::BuildHelpers(const Device& device, const std::string& selector, const std::string& scene) {
    const bool shared = std::string_view(device.info().platform) == "Portable Computing Language" &&
                        std::thread::hardware_concurrency() > 1 && !std::getenv(variable) && !scene.empty();
    std::error_code error;
    if (shared)
        folder_ =
            pel::system::makeTemporaryFolder(fs::temp_directory_path(error).string(), "pellucid-build-");
    if (!folder_.empty()) pel::system::setVariable(variable, folder_.c_str());
    starter_ = std::thread([this, selector, scene] {
        std::unique_lock lock(mutex_);
        const auto begin = std::chrono::steady_clock::now();
        const auto built = [&](auto after) {
            return changed_.wait_until(lock, begin + after, [&] { return done_; });
        };
        if (built(moment)) return;
        if (!folder_.empty()) start(selector, scene);
        if (!built(std::chrono::seconds(1)))
            std::fputs("building this scene's kernels; the driver keeps them for later runs\n", stderr);
    });
}

void BuildHelpers::start(const std::string& selector, const std::string& scene) {
    std::vector<std::string> words{pel::system::programFile(), "warm-up", scene};
    if (!selector.empty()) words.insert(words.end(), {"--device", selector});
    std::vector<std::string> variables{std::string(variable) + "=helper:" + folder_};
    if (!std::getenv("PELLUCID_CACHE"))
        variables.push_back("PELLUCID_CACHE=auto");  // no binaries, which take as long again
    for (unsigned i = 1; i < std::min(std::thread::hardware_concurrency(), mostHelpers + 1); ++i)
        helpers_.emplace_back(words, variables);
}

void BuildHelpers::finish() {
    {
        const std::lock_guard lock(mutex_);
        done_ = true;
    }
    changed_.notify_one();
    if (starter_.joinable()) starter_.join();
    for (pel::system::Child& helper : helpers_) helper.wait();
}

BuildHelpers::~BuildHelpers() {
    finish();
    if (folder_.empty()) return;
    pel::system::setVariable(variable, nullptr);
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

}  // namespace pellucid::cli
