// A build without the sample renderer imports scenes without a G-buffer.
#include "gltf/import_view.h"

namespace pellucid::cli {

bool canDraw() {
    return false;
}
void drawImport(Run&, const std::string&, io::ImportedGltf&, const ImportView&) {}

}  // namespace pellucid::cli
