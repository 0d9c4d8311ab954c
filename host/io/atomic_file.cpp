#include "io/atomic_file.h"

#include <filesystem>
#include <random>

#include "io/content_hash.h"
#include "io/input_file.h"

namespace pellucid::io {
namespace fs = std::filesystem;

// Seconds since the last write after which a temporary file counts as abandoned: for writers whose locks this
// program can see, and for others.
constexpr double lockedAge = 60, foreignAge = 86400;

// The machine that a temporary file's name contains; "" for other names.
static std::string machineOf(const std::string& name) {
    constexpr size_t tag = 8, random = 16, all = 1 + tag + 1 + random;
    const size_t end = name.rfind(".tmp");
    if (name.empty() || name[0] != '.' || end == std::string::npos || end < all) return "";
    if (name.size() > end + 4 && name[end + 4] != '.') return "";
    const std::string part = name.substr(end - all, all);
    const auto hex = [&](size_t from, size_t count) {
        return part.find_first_not_of("0123456789abcdef", from) >= from + count;
    };
    return part[0] == '.' && hex(1, tag) && part[1 + tag] == '-' && hex(2 + tag, random) ? part.substr(1, tag)
                                                                                         : "";
}

std::string temporaryName(const std::string& name) {
    const fs::path path(name);
    std::random_device random;
    return "." + path.stem().string().substr(0, 120) + "." + machineTag() + "-" +
           hexDigits(uint64_t(random()) << 32 | random()) + ".tmp" + path.extension().string().substr(0, 40);
}

std::vector<TemporaryFile> temporaryFiles(const std::string& folder) {
    std::vector<TemporaryFile> files;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string(), machine = machineOf(name);
        if (!machine.empty()) files.push_back({name, machine == machineTag() ? lockedAge : foreignAge});
    }
    return files;
}

std::string folderOf(const std::string& path) {
    const std::string parent = fs::path(path).parent_path().string();
    return parent.empty() ? "." : parent;
}

void refuseOtherThanFile(const std::string& path) {
    const std::string other = otherThanFile(path);
    if (!other.empty()) throw FileError(path, "is " + other + "; the output must be the name of a file");
}

void writeWholeFile(const std::string& path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes.data(), bytes.size());
    file.commit();
}

void checkWritable(const std::string& path) {
    const AtomicFile probe(path);  // making a file there is the only sure test; the destructor removes it
    removeAbandonedFiles(folderOf(path));
}

}  // namespace pellucid::io
