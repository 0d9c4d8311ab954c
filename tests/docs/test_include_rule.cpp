// Who may include whom (docs/dataflow.md, "Layers"): one way only.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace fs = std::filesystem;

namespace {

// A folder's own files, the standard library and other people's headers are always allowed.
const std::map<std::string, std::set<std::string>> allowed = {
    {"kernels/shared", {}},
    {"kernels/lib", {"kernels/shared"}},
    {"kernels/mesh", {"kernels/shared", "kernels/lib"}},
    {"kernels/lut", {"kernels/shared", "kernels/lib"}},
    {"kernels/eye", {"kernels/shared", "kernels/lib"}},
    {"kernels/shading", {"kernels/shared", "kernels/lib"}},
    {"kernels/diffusion", {"kernels/shared", "kernels/lib"}},
    {"host/include/pellucid", {}},
    {"host/system", {}},
    {"host/fields", {"host/include/pellucid"}},
    {"host/cl", {"kernels/shared", "host/include/pellucid", "host/system"}},
    {"host/core", {"host/fields", "kernels/shared", "host/include/pellucid", "host/cl"}},
    {"host/mesh", {"kernels/shared", "host/include/pellucid", "host/cl", "host/core"}},
    {"host/lut", {"host/fields", "kernels/shared", "host/include/pellucid", "host/cl", "host/core"}},
    {"host/eye",
     {"host/fields", "kernels/shared", "host/include/pellucid", "host/cl", "host/core", "host/lut"}},
    {"host/shading",
     {"host/fields", "kernels/shared", "host/include/pellucid", "host/cl", "host/core", "host/lut",
      "host/eye"}},
    {"host/diffusion",
     {"host/fields", "kernels/shared", "host/include/pellucid", "host/cl", "host/core", "host/mesh",
      "host/lut", "host/shading"}},
    {"host/api",
     {"host/fields", "kernels/shared", "host/include/pellucid", "host/cl", "host/core", "host/mesh",
      "host/lut", "host/eye", "host/shading", "host/diffusion"}},
    {"host/io", {"host/fields", "kernels/shared", "host/include/pellucid", "host/system"}},
    {"host/scene", {"host/fields", "host/include/pellucid", "host/io"}},
    {"host/profile_fit", {"host/include/pellucid", "host/io"}},
    {"host/sample", {"host/include/pellucid"}},
    {"bench/measure", {"host/include/pellucid", "tests/reference"}},
    // Applications: their commands are part of the command, which links them without including them.
    {"apps/batch", {"host/include/pellucid", "host/system", "host/io", "bindings/cli"}},
    {"apps/demo", {"host/io", "host/sample"}},
    {"apps/gltf", {"host/include/pellucid", "host/io", "host/sample", "bindings/cli"}},
    {"apps/batch/tests", {"host/include/pellucid", "host/io", "apps/batch", "tests"}},
    {"apps/gltf/tests", {"host/include/pellucid", "host/io", "apps/gltf", "tests"}},
    {"bindings/cli",
     {"host/fields", "host/include/pellucid", "host/system", "host/io", "host/scene", "host/profile_fit",
      "host/sample", "bench/measure", "apps/demo"}},
    {"bindings/python",
     {"host/fields", "host/include/pellucid", "host/io", "host/scene", "apps/batch", "apps/demo",
      "apps/gltf"}},
    {"examples", {"host/include/pellucid"}},
    {"bench",
     {"kernels/shared", "kernels/lib", "host/include/pellucid", "host/io", "host/sample", "apps/demo",
      "bench/measure", "tests/reference", "tests"}},
    // host/cl and host/system: compiled programs and processes, which no call of the library shows.
    {"tests",
     {"host/fields", "kernels/shared", "host/include/pellucid", "host/cl", "host/system", "host/io",
      "host/scene", "host/profile_fit", "host/sample", "apps/batch", "apps/gltf", "apps/gltf/tests",
      "bench/measure", "tests/reference"}},
    {"tests/reference", {}},
    {"tests/windows", {"host/io", "host/system", "apps/gltf", "tests"}},
};

const fs::path root = PELLUCID_SOURCE_DIR;

// The layer that a file belongs to: the longest entry of the table that is a folder above it, or "".
std::string layerOf(const fs::path& relative) {
    for (fs::path folder = relative.parent_path(); !folder.empty(); folder = folder.parent_path())
        if (allowed.contains(folder.generic_string())) return folder.generic_string();
    return "";
}

// Where an include lands inside the project, or "" for headers from elsewhere.
std::string resolve(const fs::path& from, const std::string& included) {
    for (const fs::path& base : {from.parent_path(), root / "host", root / "kernels", root / "host/include",
                                 root / "apps", root / "tests", root / "bindings", root / "bench"}) {
        std::error_code error;
        if (fs::exists(base / included, error))
            return layerOf(fs::relative(fs::canonical(base / included), root));
    }
    return "";
}

// Calls with every line of the sources below a folder, and where it stands.
void eachLine(
    const std::string& top,
    const std::function<void(const fs::path&, const std::string& place, const std::string& line)>& visit) {
    static const std::set<std::string> endings{".h", ".hpp", ".c", ".cpp", ".cl", ".clh"};
    for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
        if (!entry.is_regular_file() || !endings.contains(entry.path().extension())) continue;
        std::ifstream in(entry.path());
        int number = 0;
        for (std::string line; std::getline(in, line);)
            visit(entry.path(), entry.path().string() + ":" + std::to_string(++number), line);
    }
}

}  // namespace

TEST(IncludeRule, EveryIncludeGoesOneWay) {
    const std::regex directive(R"(^\s*#\s*include\s*["<]([^">]+)[">])");
    size_t checked = 0;
    for (const char* top : {"kernels", "host", "apps", "bindings", "examples", "bench", "tests"})
        eachLine(top, [&](const fs::path& file, const std::string& place, const std::string& line) {
            std::smatch match;
            if (line.find("include") == std::string::npos || !std::regex_search(line, match, directive))
                return;
            const std::string layer = layerOf(fs::relative(file, root));
            const std::string target = layer.empty() ? "" : resolve(file, match[1]);
            if (target.empty() || target == layer) return;
            ++checked;
            EXPECT_TRUE(allowed.at(layer).contains(target))
                << place << ": " << layer << " must not include " << target << " (" << match[1] << ")";
        });
    EXPECT_GT(checked, 100u);
}

// What differs between systems is in folders of their names; all else is the same code everywhere.
// bench/measure and the native module of Python are for POSIX systems (docs/guide/install.md).
TEST(IncludeRule, OneSystemAloneHasFoldersOfItsOwn) {
    const std::regex header(R"(^\s*#\s*include\s*<(windows\.h|io\.h|process\.h|unistd\.h|fcntl\.h|)"
                            R"(dlfcn\.h|elf\.h|pwd\.h|poll\.h|sys/[^>]*)>)");
    const std::regex use(R"(\b(v?fork|dlopen|dlsym|dladdr|LoadLibrary[AW]?)\(|"/proc/)");
    size_t apart = 0;
    for (const char* top : {"host", "apps", "bindings/cli"})
        eachLine(top, [&](const fs::path& file, const std::string& place, const std::string& line) {
            if (file.extension() != ".h" && file.extension() != ".cpp") return;
            if (!std::regex_search(line, header) && !std::regex_search(line, use)) return;
            ++apart;
            const std::string folder = file.parent_path().filename();
            EXPECT_TRUE(folder == "posix" || folder == "windows") << place << ": " << line;
        });
    EXPECT_GT(apart, 10u);
}
