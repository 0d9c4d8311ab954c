// The manifest of `pellucid batch`: TOML that lists look-up tables one by one and as grids. Keys:
// docs/guide/batch.md.
#pragma once
#include <future>
#include <map>
#include <pellucid/pellucid.hpp>

namespace pellucid::io {

// One table to make.
struct BatchTable {
    PelLutInfo info;                      // kind and description, without a profile handle
    std::shared_future<Profile> profile;  // invalid for specular tables; one of pigments is made by get()

    PelLutInfo filled() const;  // with the handle
};

// One file to make.
struct BatchEntry {
    std::vector<BatchTable> tables;  // one; of a stack as many of one size, below each other
    PelLutEncoding encoding;         // float or half
    std::string key;                 // everything that determines the texels, as text
    std::string name;                // given by the manifest; may be empty
    std::string file;                // name.exr, or kind and hash of the key: equal requests have equal names
    int line;                        // of the manifest
};

struct BatchError {
    int line;
    std::string message;
    size_t files = 1;  // that are left out
};

struct BatchManifest {
    std::vector<BatchEntry> entries;              // in order, each file once
    std::vector<BatchError> errors;               // wrong entries; the others are valid
    size_t duplicates = 0;                        // left out because an earlier entry is the same
    std::string text;                             // of the manifest
    std::map<std::string, std::string> profiles;  // text of each profile file that is named
};

// Throws FileError if the file is not a manifest. Wrong entries are returned as errors. Profile files are
// found relative to the manifest.
BatchManifest readManifest(const std::string& path);

// The same without reading any file: `path` is for messages, `profiles` as in BatchManifest.
BatchManifest parseManifest(const std::string& path, const std::string& text,
                            const std::map<std::string, std::string>& profiles);

// The bytes of an entry's file. Waits for this entry only, so that several threads keep a device busy.
// Throws pellucid::Error.
std::string makeEntryFile(const Device& device, const BatchEntry& entry);

// The index says which tables of a manifest are in a folder, and what each of them is (docs/guide/batch.md),
// one line per table. That of tables.toml is tables.index.json, so that several manifests can share a folder.
// `there`: for each entry, whether its file exists.
std::string batchIndexName(const std::string& manifestPath);
std::string batchIndex(const BatchManifest& manifest, const std::string& manifestPath,
                       const std::vector<bool>& there);

}  // namespace pellucid::io
