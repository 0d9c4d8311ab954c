#include "io/content_hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace pellucid::io {

uint64_t contentHash(std::string_view bytes) {
    return XXH64(bytes.data(), bytes.size(), 0);
}

}  // namespace pellucid::io
