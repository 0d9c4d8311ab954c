// fuzz_readers [--seconds S | --runs N] [--seed N] [--only READER] [--corpus FOLDER] [--keep FOLDER]
//
// Gives damaged input to every reader of files: first inputs that once exposed a fault (FOLDER/READER/*),
// then whole files, then mutants of those, which are determined by the seed and their number. A reader may
// throw its documented error. It must not crash, throw another error, run long or use much memory. Readers
// run in a child process; if it dies, the input is kept and another child continues with the next one.
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <new>
#include <set>

#include "fuzz/readers.h"
#include "io/input_file.h"

namespace {

namespace fs = std::filesystem;
constexpr unsigned longestRead = 20;  // s, of one input, under sanitizers and beside other work
constexpr int faultCode = 86;

using Options = std::map<std::string, std::string>;

// Shared by parent and child: where the child is, how many inputs of this reader were refused, and the input.
struct Place {
    std::atomic<size_t> reader, input, refused, size;
    char name[32], what[1024], bytes[1 << 20];
};

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Input `i` of a reader: the corpus and its own seeds, then mutants.
std::string inputOf(const fuzz::Reader& reader, const std::vector<std::string>& whole, uint64_t seed,
                    uint64_t i) {
    if (i < whole.size()) return whole[i];
    uint64_t name = 0;
    for (char c : reader.name) name = 131 * name + uint8_t(c);
    fuzz::Random random(seed * 0x100000001b3u + name * 0x9e3779b9u + i * 0x2545f4914f6cdd1du);
    if (reader.structured && random.below(4)) return reader.structured(random);
    const std::string bytes = fuzz::mutant(random, reader.seeds, reader.words);
    return reader.mend && random.below(8) ? reader.mend(bytes) : bytes;
}

// Continues where the last child ended. With a time limit, each reader has its share.
void work(const Options& o, Place& place, double begin) {
    const std::vector<fuzz::Reader> readers = fuzz::readers();
    const std::string &only = o.at("--only"), seconds = o.at("--seconds");
    const uint64_t runs = std::stoull(o.at("--runs")), seed = std::stoull(o.at("--seed"));
    for (; place.reader < readers.size(); ++place.reader, place.input = place.refused = 0) {
        const fuzz::Reader& reader = readers[place.reader];
        if (!only.empty() && reader.name != only) continue;
        std::snprintf(place.name, sizeof place.name, "%s", reader.name.c_str());
        std::set<fs::path> files;
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(fs::path(o.at("--corpus")) / reader.name, none))
            files.insert(entry.path());
        std::vector<std::string> whole;
        for (const fs::path& file : files) whole.push_back(pellucid::io::readWholeFile(file));
        whole.insert(whole.end(), reader.seeds.begin(), reader.seeds.end());
        const double share = only.empty() ? double(place.reader + 1) / double(readers.size()) : 1,
                     end = begin + share * std::stod(seconds);
        for (; place.input < whole.size() + (seconds == "0" ? runs
                                             : now() < end  ? SIZE_MAX / 2
                                                            : 0);
             ++place.input) {
            const std::string bytes = inputOf(reader, whole, seed, place.input);
            place.size = std::min(bytes.size(), sizeof place.bytes);
            std::memcpy(place.bytes, bytes.data(), place.size);
            const bool seedFile = place.input < whole.size() && place.input >= files.size();
            ::alarm(longestRead);
            try {
                reader.read(bytes);
            } catch (const std::exception& e) {
                ++place.refused;
                if (fuzz::promised(e) && !seedFile) continue;
                std::snprintf(place.what, sizeof place.what, "%s: %s",
                              seedFile ? "a whole file is refused" : "an error that is not promised",
                              e.what());
                ::_exit(faultCode);
            }
        }
        std::printf("%-10s %9zu inputs, %3.0f %% refused\n", place.name, place.input.load(),
                    100.0 * double(place.refused) / double(place.input));
    }
    ::alarm(0);
}

// How the child ended, "" without a fault.
std::string ending(pid_t child, const Place& place) {
    int status = 0;
    ::waitpid(child, &status, 0);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) return "takes more than 20 s";
    if (WIFSIGNALED(status)) return std::string("crashes: ") + strsignal(WTERMSIG(status));
    if (WEXITSTATUS(status) == faultCode) return place.what;
    return WEXITSTATUS(status) ? "ends the process with code " + std::to_string(WEXITSTATUS(status)) : "";
}

}  // namespace

int main(int argc, char** argv) {
    Options o{{"--seconds", "0"}, {"--runs", "200"}, {"--seed", "1"},
              {"--only", ""},     {"--corpus", ""},  {"--keep", "fuzz-faults"}};
    for (int i = 1; i + 1 < argc; i += 2) o.at(argv[i]) = argv[i + 1];
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    ::setenv("PELLUCID_INPUT_LIMIT_MIB", "64", 1);
#ifndef __SANITIZE_ADDRESS__
    // Address space: what takes more gets std::bad_alloc
    const rlimit memory{rlim_t{6} << 30, rlim_t{6} << 30};
    ::setrlimit(RLIMIT_AS, &memory);
#endif
    auto& place = *new (
        ::mmap(nullptr, sizeof(Place), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Place();
    const double begin = now();
    int faults = 0;
    for (; faults < 200; ++faults, ++place.input) {
        const pid_t child = ::fork();
        if (child == 0) {
            work(o, place, begin);
            ::_exit(0);
        }
        const std::string how = ending(child, place);
        if (how.empty()) break;
        if (!place.name[0]) {
            std::printf("fuzz_readers cannot begin: %s\n", how.c_str());
            return 1;
        }
        const std::string name =
            o["--keep"] + "/" + place.name + "-" + o["--seed"] + "-" + std::to_string(place.input);
        fs::create_directories(o["--keep"]);
        std::ofstream(name, std::ios::binary).write(place.bytes, std::streamsize(place.size));
        std::printf("%s, input %zu of seed %s: %s\n  kept as %s\n", place.name, place.input.load(),
                    o["--seed"].c_str(), how.c_str(), name.c_str());
    }
    std::printf("%d faults\n", faults);
    return faults > 0;
}
