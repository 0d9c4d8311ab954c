#include "io/input_file.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace pellucid::io {
namespace fs = std::filesystem;

constexpr const char* limitVariable = "PELLUCID_INPUT_LIMIT_MIB";

uint64_t inputLimit() {
    constexpr uint64_t standard = 2048;
    const char* text = std::getenv(limitVariable);
    if (!text || !*text) return standard << 20;
    uint64_t mib = 0;
    const char* end = text + std::strlen(text);
    const auto [at, error] = std::from_chars(text, end, mib);
    if (error != std::errc() || at != end || mib == 0 || mib > uint64_t{1} << 40)
        throw FileError(limitVariable,
                        std::string("is \"") + text + "\"; a whole number of MiB from 1 on would be right");
    return mib << 20;
}

std::string tooLarge(double bytes, uint64_t limit) {
    return printed("%.1f MiB, more than the limit of %.0f MiB (%s raises it)", bytes / (1 << 20),
                   double(limit) / (1 << 20), limitVariable);
}

void refuseTooLarge(const std::string& path, uint64_t bytes, uint64_t limit) {
    if (limit == inputLimit()) throw FileError(path, "takes " + tooLarge(double(bytes), limit));
    throw FileError(path, concat("has ", bytes, " bytes or more; a text of this kind may have ", limit));
}

std::string extensionOf(const std::string& path) {
    std::string extension = fs::path(path).extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return extension;
}

std::string requireExtension(const std::string& path, std::initializer_list<std::string_view> known) {
    const std::string extension = extensionOf(path);
    if (std::find(known.begin(), known.end(), extension) != known.end()) return extension;
    std::string list;
    for (std::string_view k : known) list.append(list.empty() ? "." : ", .").append(k);
    throw ExtensionError(
        path, (extension.empty() ? "has no extension" : "has the unknown extension '." + extension + "'") +
                  "; known here: " + list);
}

}  // namespace pellucid::io
