#include "cl/build_helpers.h"

#include <algorithm>
#include <cstdint>

#include "cl/platform.h"

namespace pel::cl {
namespace {

// The program that compiles: near this library, or what PELLUCID_BUILD_HELPER names. "": none.
std::string helperProgram() {
    if (const char* named = std::getenv("PELLUCID_BUILD_HELPER"))
        return std::string(named) == "off" ? "" : named;
    static const char here = 0;
    for (const char* folder : {"", "pellucid/"}) {
        const std::string name = system::folderOf(&here) + folder + PELLUCID_HELPER_FILE;
        std::error_code error;
        if (std::filesystem::exists(name, error)) return name;
    }
    return "";
}

bool send(system::Child& to, const std::string& options, const std::string& source) {
    const uint64_t sizes[2] = {options.size(), source.size()};
    return to.write(sizes, sizeof sizes) && to.write(options.data(), options.size()) &&
           to.write(source.data(), source.size());
}

// False if the process has ended.
bool receive(system::Child& from, std::string& binary) {
    uint64_t size = 0;
    if (!from.read(&size, sizeof size)) return false;
    binary.resize(size);
    return from.read(binary.data(), size);
}

}  // namespace

BuildHelpers::BuildHelpers(cl_device_id device, unsigned most) : most_(most) {
    const std::vector<cl_device_id> all = allDevices();
    const auto found = std::ranges::find(all, device);
    const std::string program = helperProgram();
    if (!program.empty() && isPocl(device) && found != all.end())
        words_ = {program, std::to_string(found - all.begin()), infoString(device, CL_DEVICE_NAME)};
}

BuildHelpers::~BuildHelpers() = default;

std::string BuildHelpers::compile(const std::string& options, const std::string& source) {
    std::unique_lock lock(mutex_);
    freed_.wait(lock, [&] { return cancelled_ || words_.empty() || !idle_.empty() || busy_.size() < most_; });
    if (!cancelled_ && words_.empty()) return {};
    throwIfCancelled();
    if (idle_.empty()) idle_.push_back(std::make_unique<system::Child>(words_));
    busy_.push_back(std::move(idle_.back()));
    idle_.pop_back();
    system::Child* const mine = busy_.back().get();
    lock.unlock();
    std::string binary;
    const bool alive = send(*mine, options, source) && receive(*mine, binary);
    lock.lock();
    const auto place = std::ranges::find(busy_, mine, [](const auto& child) { return child.get(); });
    if (alive)
        idle_.push_back(std::move(*place));
    else
        words_.clear();  // another process would fail, too
    busy_.erase(place);
    freed_.notify_all();
    throwIfCancelled();
    return alive ? binary : std::string();
}

void BuildHelpers::cancel() {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    for (const auto& child : busy_) child->end();
    freed_.notify_all();
}

void BuildHelpers::checkCancelled() {
    const std::lock_guard lock(mutex_);
    throwIfCancelled();
}

}  // namespace pel::cl
