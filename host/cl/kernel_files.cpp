#include "cl/kernel_files.h"

#include <set>

#include "cl/error.h"

namespace pel::cl {
namespace {

std::string_view find(std::string_view name) {
    for (const KernelFile& file : kernelFiles())
        if (file.name == name) return file.text;
    fail(PEL_ERROR_UNKNOWN, "no kernel file named ", name, " is embedded in this library");
}

void expand(std::string_view name, std::set<std::string_view>& seen, std::string& out) {
    static constexpr std::string_view directive = "#include \"";
    std::string_view rest = find(name);
    // With #line, compiler messages name the file that a reader can open.
    out += text("#line 1 \"", name, "\"\n");
    for (int line = 1; !rest.empty(); ++line) {
        const size_t end = std::min(rest.find('\n'), rest.size() - 1);
        const std::string_view current = rest.substr(0, end + 1);
        rest.remove_prefix(end + 1);
        if (!current.starts_with(directive)) {
            out += current;
            continue;
        }
        std::string_view included = current.substr(directive.size());
        included = included.substr(0, included.find('"'));
        for (const KernelFile& file : kernelFiles())
            if (file.name == included && seen.insert(file.name).second) expand(file.name, seen, out);
        find(included);
        out += text("#line ", line + 1, " \"", name, "\"\n");
    }
}

}  // namespace

std::string kernelSource(std::span<const std::string> names) {
    std::string out;
    std::set<std::string_view> seen;
    for (const std::string& name : names)
        if (seen.insert(name).second) expand(name, seen, out);
    return out;
}

}  // namespace pel::cl
