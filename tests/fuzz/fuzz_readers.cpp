// fuzz_readers [--seconds S | --runs N] [--seed N] [--only READER] [--corpus FOLDER] [--keep FOLDER]
//
// Gives damaged input to every reader of files: first inputs that once exposed a fault (FOLDER/READER/*),
// then mutants of valid files, which are determined by the seed and their number. A reader may throw its
// documented error. It must not crash, throw another error, run long or use much memory. Readers run in a
// child process; if it dies, the input is kept and another child continues with the next one.
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <optional>
#include <sstream>

#include "fuzz/mutate.h"
#include "fuzz/readers.h"

namespace {

namespace fs = std::filesystem;
constexpr int mostReaders = 64;
constexpr double longestRead = 20;  // s, of one input, under sanitizers and beside other work
constexpr int faultCode = 86;

struct Options {
    double seconds = 0;
    uint64_t runs = 200, seed = 1;
    std::string only, corpus, keep = "fuzz-faults";
};

// Shared by parent and child: the child's position, and how many inputs of each reader were read and refused.
struct Place {
    std::atomic<int> reader, count;
    std::atomic<uint64_t> input;
    std::atomic<uint64_t> done[mostReaders], refused[mostReaders];
    char names[mostReaders][32];
    char what[1024];
};

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<std::string> corpusOf(const Options& o, const std::string& reader) {
    std::vector<fs::path> files;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(fs::path(o.corpus) / reader, none))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<std::string> texts;
    for (const fs::path& file : files) {
        std::ostringstream text;
        text << std::ifstream(file, std::ios::binary).rdbuf();
        texts.push_back(text.str());
    }
    return texts;
}

// Input `i` of a reader: the corpus, its own seeds, then mutants.
std::string inputOf(const fuzz::Reader& reader, const std::vector<std::string>& corpus, const Options& o,
                    uint64_t i) {
    if (i < corpus.size()) return corpus[i];
    if (i - corpus.size() < reader.seeds.size()) return reader.seeds[i - corpus.size()];
    uint64_t name = 0;
    for (char c : reader.name) name = 131 * name + uint8_t(c);
    fuzz::Random random(o.seed * 0x100000001b3u + name * 0x9e3779b9u + i * 0x2545f4914f6cdd1du);
    if (reader.structured && random.below(4)) return reader.structured(random);
    const std::string bytes = fuzz::mutant(random, reader.seeds, reader.words);
    return reader.mend && random.below(8) ? reader.mend(bytes) : bytes;
}

void work(const Options& o, Place& place, double end) {
    const std::vector<fuzz::Reader> readers = fuzz::readers();
    place.count = int(readers.size());
    std::vector<std::vector<std::string>> corpora;
    for (const fuzz::Reader& r : readers) corpora.push_back(corpusOf(o, r.name));
    for (size_t k = 0; k < readers.size(); ++k) std::strncpy(place.names[k], readers[k].name.c_str(), 31);
    constexpr uint64_t turn = 50;  // inputs of one reader before the next reader
    for (bool more = true; more;) {
        more = false;
        for (size_t k = 0; k < readers.size(); ++k) {
            if (!o.only.empty() && readers[k].name != o.only) continue;
            const uint64_t all =
                o.seconds > 0 ? ~uint64_t{0} : corpora[k].size() + readers[k].seeds.size() + o.runs;
            for (uint64_t t = 0; t < turn && place.done[k] < all; ++t) {
                if (o.seconds > 0 && now() > end) return;
                place.reader = int(k);
                const uint64_t i = place.input = place.done[k]++;
                const std::string bytes = inputOf(readers[k], corpora[k], o, i);
                const bool seed = i >= corpora[k].size() && i < corpora[k].size() + readers[k].seeds.size();
                try {
                    readers[k].read(bytes);
                } catch (const std::exception& e) {
                    ++place.refused[k];
                    if (!fuzz::promised(e) || seed) {
                        std::snprintf(
                            place.what, sizeof place.what, "%s%s",
                            seed ? "a whole file is refused: " : "an error that is not promised: ", e.what());
                        ::_exit(faultCode);
                    }
                }
                more |= place.done[k] < all;
            }
        }
    }
}

// Saves the input at which the child died.
std::string keep(const Options& o, const Place& place) {
    const std::string name = o.keep + "/" + place.names[place.reader] + "-" + std::to_string(o.seed) + "-" +
                             std::to_string(place.input);
    const pid_t child = ::fork();
    if (child == 0) {
        fs::create_directories(o.keep);
        for (const fuzz::Reader& r : fuzz::readers())
            if (r.name == place.names[place.reader])
                std::ofstream(name, std::ios::binary) << inputOf(r, corpusOf(o, r.name), o, place.input);
        ::_exit(0);
    }
    ::waitpid(child, nullptr, 0);
    return name;
}

// Waits for the child, and kills it if one input takes too long. Returns how it ended, or "" without a fault.
std::string ending(pid_t child, Place& place) {
    uint64_t seen = ~uint64_t{0};
    int reader = -1, status = 0;
    double since = now();
    while (::waitpid(child, &status, WNOHANG) == 0) {
        ::usleep(20000);
        if (place.input != seen || place.reader != reader) {
            seen = place.input, reader = place.reader;
            since = now();
        } else if (reader >= 0 && now() - since > longestRead) {
            ::kill(child, SIGKILL);
            ::waitpid(child, &status, 0);
            return "takes more than 20 s";
        }
    }
    if (WIFSIGNALED(status)) return std::string("crashes: ") + strsignal(WTERMSIG(status));
    if (WEXITSTATUS(status) == faultCode) return place.what;
    return WEXITSTATUS(status) ? "ends the process with code " + std::to_string(WEXITSTATUS(status)) : "";
}

Options optionsOf(int argc, char** argv) {
    Options o;
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::string name = argv[i], value = argv[i + 1];
        if (name == "--seconds")
            o.seconds = std::stod(value);
        else if (name == "--runs")
            o.runs = std::stoull(value);
        else if (name == "--seed")
            o.seed = std::stoull(value);
        else if (name == "--only")
            o.only = value;
        else if (name == "--corpus")
            o.corpus = value;
        else if (name == "--keep")
            o.keep = value;
        else
            throw std::invalid_argument("no option " + name);
    }
    return o;
}

}  // namespace

int main(int argc, char** argv) {
    const Options o = optionsOf(argc, argv);
    ::setenv("PELLUCID_INPUT_LIMIT_MIB", "64", 1);
#ifndef __SANITIZE_ADDRESS__
    // Address space: what takes more gets std::bad_alloc
    const rlimit memory{rlim_t{6} << 30, rlim_t{6} << 30};
    ::setrlimit(RLIMIT_AS, &memory);
#endif
    auto& place = *new (
        ::mmap(nullptr, sizeof(Place), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Place();
    const double end = now() + o.seconds;
    int faults = 0;
    for (;;) {
        place.reader = -1;
        const pid_t child = ::fork();
        if (child == 0) {
            work(o, place, end);
            std::fflush(nullptr);
            ::_exit(0);
        }
        const std::string how = ending(child, place);
        if (how.empty()) break;
        if (place.reader < 0) {
            std::printf("fuzz_readers cannot begin: %s\n", how.c_str());
            return 1;
        }
        ++faults;
        std::printf("%s, input %llu of seed %llu: %s\n  kept as %s\n", place.names[place.reader],
                    static_cast<unsigned long long>(place.input), static_cast<unsigned long long>(o.seed),
                    how.c_str(), keep(o, place).c_str());
        std::fflush(stdout);
        if (o.seconds > 0 && now() > end) break;
        if (faults >= 200) break;
    }
    for (int k = 0; k < place.count; ++k)
        if (place.done[k])
            std::printf("%-10s %9llu inputs, %3.0f %% refused\n", place.names[k],
                        static_cast<unsigned long long>(place.done[k]),
                        100.0 * double(place.refused[k]) / double(place.done[k]));
    std::printf("%d faults\n", faults);
    return faults > 0;
}
