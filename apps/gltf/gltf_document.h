// The container of a glTF: its JSON, its buffers, and accessors decoded with every bound checked. A small
// file can name the same accessor or image many times, so all that is decoded counts towards inputLimit().
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "gltf/gltf_file.h"
#include "gltf/gltf_value.h"

namespace pellucid::io {

class GltfDocument {
  public:
    GltfDocument(const std::string& path, const std::string& bytes, const GltfResource& resource);

    GltfValue root() const { return GltfValue(path_, *json_, ""); }
    const std::string& path() const { return path_; }

    // The accessor that `owner.key` refers to: `components` numbers per element, normalised integers as
    // fractions.
    std::vector<float> floats(const GltfValue& owner, const char* key, size_t components) const;
    std::vector<uint32_t> indices(const GltfValue& owner, const char* key) const;

    GltfImage image(size_t index) const;

    // Counts `bytes` of decoded data. Throws FileError at `value` once the total exceeds inputLimit().
    void spend(const GltfValue& value, double bytes) const;

  private:
    struct Span {
        const char* data = nullptr;
        uint64_t size, stride;
    };
    struct Layout;

    std::string resource(const GltfValue& value) const;  // what a "uri" names
    const std::string& buffer(const GltfValue& view) const;
    Span view(const GltfValue& owner, const char* key) const;
    Layout layout(const GltfValue& accessor) const;
    template <class Store>
    void read(const GltfValue& accessor, const Layout& layout, Store&& store) const;
    template <class Store>
    void readSparse(const GltfValue& accessor, const Layout& layout, Store&& store) const;

    std::string path_;
    const GltfResource& resource_;
    std::shared_ptr<const nlohmann::json> json_;
    std::string binary_;                // the chunk of a .glb
    std::vector<std::string> buffers_;  // of the document
    mutable double decodedBytes_ = 0;
};

}  // namespace pellucid::io
