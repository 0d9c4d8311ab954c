// The index of a batch: JSON that says which tables of a manifest are in a folder, and what each of them is.
#pragma once
#include <string>
#include <vector>

#include "batch/batch_manifest.h"

namespace pellucid::io {

// The index of tables.toml is tables.index.json, so that several manifests can share a folder.
std::string batchIndexName(const std::string& manifestPath);

// The text of the index, one line per table. `there`: for each entry of the manifest, whether its file
// exists. Keys: docs/guide/batch.md.
std::string batchIndex(const BatchManifest& manifest, const std::string& manifestPath,
                       const std::vector<bool>& there);

}  // namespace pellucid::io
