// Every reader of untrusted files as a function of bytes, with seed files.
#pragma once
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <pellucid/pellucid.hpp>
#include <sstream>

#include "fuzz/mutate.h"

namespace fuzz {

struct Reader {
    std::string name;
    std::vector<std::string> seeds;  // whole files that it reads
    // Returns, or throws a documented error; anything else is a fault.
    std::function<void(const std::string& bytes)> read;
    // Corrects check sums after damage, so that the damage reaches the parser; empty if there are none.
    std::function<std::string(std::string bytes)> mend;
    std::vector<std::string> words;  // to put in
    // Makes an input that is damaged inside a structure that stays whole; none: every input is a mutant of
    // bytes.
    std::function<std::string(Random&)> structured = {};
};

// In an order that does not change. Writes seeds into a temporary folder and removes it.
std::vector<Reader> readers();

// Whether `error` is a documented error of the readers.
bool promised(const std::exception& error);

// Parts of readers(), by what they read.

class Folder {
  public:
    Folder() {
        char name[] = "/tmp/pellucid-fuzz-XXXXXX";
        if (!::mkdtemp(name)) throw std::runtime_error("no temporary folder");
        path_ = name;
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    std::string operator/(const std::string& name) const { return path_ + "/" + name; }

  private:
    std::string path_;
};

inline std::string bytesOf(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

// The words of a text between blanks.
inline std::vector<std::string> wordsOf(const std::string& text) {
    std::istringstream words(text);
    return {std::istream_iterator<std::string>(words), {}};
}

// A small 8-bit picture, written by OpenImageIO.
std::string picture(const Folder& folder, const std::string& extension, int channels);

void addMeshes(std::vector<Reader>& all, const Folder& folder);
void addImages(std::vector<Reader>& all, const Folder& folder);
Reader table(const Folder& folder, const pellucid::Device& device);
Reader topology(const pellucid::Device& device);
Reader gltfScenes(const Folder& folder);

}  // namespace fuzz
