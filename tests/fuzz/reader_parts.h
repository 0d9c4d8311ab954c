// Readers by what they read, in the order that readers() has.
#pragma once
#include "fuzz/readers.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <pellucid/pellucid.hpp>
#include <sstream>

namespace fuzz {

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
