#pragma once
#include <cstring>

#include "system/process.h"

namespace pel::system {

// The table that a module exports as `symbol`, with a `version`; nullptr and the reason if the module cannot
// be loaded (openBeside) or belongs to another version.
template <class Table>
const Table* tableOfModule(const void* address, const std::string& file, const char* symbol,
                           const char* version, std::string& why) {
    void* const module = openBeside(address, file, why);
    if (!module) return nullptr;
    const auto* table = static_cast<const Table*>(symbolIn(module, symbol));
    if (table && std::strcmp(table->version, version) == 0) return table;
    why = file + " belongs to another version of pellucid";
    return nullptr;
}

}  // namespace pel::system
