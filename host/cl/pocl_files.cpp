// Incomplete files of PoCL's cache: a disk was full, or a machine lost power.
#include <chrono>
#include <cstring>
#include <fstream>

#include "cl/machine.h"
#include "cl/pocl_cache.h"

namespace pel::cl {
namespace fs = std::filesystem;
namespace {

// The head of a 64-bit ELF file (System V ABI, "ELF Header"), because not every system has a header for it.
struct ElfHeader {
    unsigned char identity[16];  // begins with a magic number; [4] is 2 in 64-bit files
    uint16_t kinds[2];
    uint32_t version;
    uint64_t entry, programs, sections;  // offsets, of the tables from the file's begin
    uint32_t flags;
    uint16_t size, programSize, programCount, sectionSize, sectionCount, names;
};
static_assert(sizeof(ElfHeader) == 64);

// Whether a shared library has its section headers, which come last.
bool wholeElf(std::ifstream& file, uint64_t size) {
    ElfHeader header;
    if (!file.read(reinterpret_cast<char*>(&header), sizeof header) || std::memcmp(header.identity,
                                                                                   "\x7f"
                                                                                   "ELF",
                                                                                   4) != 0)
        return false;
    if (header.identity[4] != 2) return true;  // another kind of file
    return header.sections <= size &&
           uint64_t(header.sectionCount) * header.sectionSize <= size - header.sections;
}

// LLVM bitcode (llvm.org/docs/BitCodeFormat.html): a magic number, then blocks up to the end of the file. A
// block begins with a word for its kind and a word with the number of words that follow.
bool wholeBitcode(std::ifstream& file, uint64_t size) {
    char magic[4];
    if (!file.read(magic, sizeof magic) || std::memcmp(magic, "BC\xC0\xDE", 4) != 0) return false;
    uint64_t at = sizeof magic;
    while (at < size) {
        uint32_t block[2];
        if (!file.seekg(std::streamoff(at)) || !file.read(reinterpret_cast<char*>(block), sizeof block))
            return false;
        constexpr uint32_t enterBlock = 1;
        if ((block[0] & 3) != enterBlock) return false;
        at += sizeof block + 4 * uint64_t(block[1]);
    }
    return at == size;
}

bool whole(const fs::path& path, uint64_t size) {
    std::ifstream file(path, std::ios::binary);
    return path.extension() == ".so" ? wholeElf(file, size) : wholeBitcode(file, size);
}

}  // namespace

// PoCL's folders: two letters, then the rest of a program's hash; in it program.bc, and a .so per kernel.
unsigned removeDamagedPrograms(const fs::path& folder) {
    // Skips files that were complete at the last check and have not been written since, and files that
    // another process may be writing. A large cache takes long to walk: programs that nobody used in the ten
    // minutes before the last check are skipped whole, since PoCL touches last_accessed when it loads a
    // program, and kernels follow when they are first launched. After a restart of the machine all files are
    // read, since it may have lost power.
    const fs::path stamp = folder / "checked";
    const auto now = fs::file_time_type::clock::now();
    std::error_code error;
    const fs::file_time_type before = fs::last_write_time(stamp, error);
    const bool first = error || now - before > std::chrono::duration<double>(uptime());
    unsigned removed = 0;
    for (auto letters = fs::directory_iterator(folder, error); !error && letters != fs::directory_iterator();
         letters.increment(error)) {
        const std::string name = letters->path().filename().string();
        std::error_code inner;
        if (name.starts_with("tempfile_") || name.starts_with("tempdir_")) {  // of a process that was killed
            const auto written = letters->last_write_time(inner);
            if (!inner && now - written > std::chrono::hours(1)) fs::remove_all(*letters, inner);
            continue;
        }
        if (name.size() != 2) continue;
        for (auto program = fs::directory_iterator(*letters, inner);
             !inner && program != fs::directory_iterator(); program.increment(inner)) {
            bool damaged = false;
            std::error_code gone;  // by another process
            const auto used = fs::last_write_time(program->path() / "last_accessed", gone);
            if (!gone && !first && used < before - std::chrono::minutes(10)) continue;
            gone.clear();
            for (auto at = fs::recursive_directory_iterator(*program, gone);
                 !damaged && !gone && at != fs::recursive_directory_iterator(); at.increment(gone)) {
                const fs::path& path = at->path();
                if (path.extension() != ".so" && path.extension() != ".bc") continue;
                std::error_code missing;
                const auto written = at->last_write_time(missing);
                const uint64_t size = at->file_size(missing);
                damaged = !missing && (first || written >= before) && !whole(path, size);
            }
            if (damaged && fs::remove_all(*program, gone) > 0) ++removed;
        }
    }
    std::ofstream(stamp).put('\n');
    fs::last_write_time(stamp, now - std::chrono::seconds(10), error);
    return removed;
}

}  // namespace pel::cl
