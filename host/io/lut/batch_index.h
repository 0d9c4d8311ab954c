// The index of a batch: JSON that says which tables of a manifest are in a folder, and what each of them is.
#pragma once
#include <string>
#include <vector>

#include "io/lut/batch_manifest.h"

namespace pellucid::io {

// The file's name, from the manifest's: tables.toml has tables.index.json. Manifests that share a folder have an index each.
std::string batchIndexName(const std::string& manifestPath);

// The text, a line per table. `there`: per entry of the manifest, whether its file is there. Keys: docs/guide/batch.md.
std::string batchIndex(const BatchManifest& manifest, const std::string& manifestPath,
                       const std::vector<bool>& there);

}  // namespace pellucid::io
