// The container of a glTF: its JSON, its buffers, and accessors decoded with every bound checked. A small
// file can name the same accessor or image many times, so all decoded data count towards inputLimit().
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "gltf/gltf_file.h"

namespace pellucid::io {

// A value of the JSON with its location in the file, which every message names.
class GltfValue {
  public:
    GltfValue(const std::string& file, const nlohmann::json& json, std::string where)
        : file_(&file), json_(&json), where_(std::move(where)) {}

    [[noreturn]] void fail(const std::string& message) const;

    bool has(const char* key) const;
    // A member, which must be there.
    GltfValue operator[](const char* key) const;
    // Of an array; the index is below size().
    GltfValue operator[](size_t index) const;
    // Elements of an array member; 0 if there is no such member.
    size_t count(const char* key) const { return has(key) ? (*this)[key].size() : 0; }
    // The extension NAME of this object; call hasExtension first.
    bool hasExtension(const char* name) const { return has("extensions") && (*this)["extensions"].has(name); }
    GltfValue extension(const char* name) const { return (*this)["extensions"][name]; }

    size_t size() const;  // of an array
    double number(double low, double high) const;
    uint64_t whole(uint64_t most) const;  // 0 to `most`
    const std::string& text() const;
    const std::string& where() const { return where_; }

    // Of a member, or `otherwise` if it is not there.
    double number(const char* key, double otherwise, double low, double high) const {
        return has(key) ? (*this)[key].number(low, high) : otherwise;
    }
    uint64_t whole(const char* key, uint64_t otherwise, uint64_t most) const {
        return has(key) ? (*this)[key].whole(most) : otherwise;
    }
    std::string text(const char* key, const std::string& otherwise) const {
        return has(key) ? (*this)[key].text() : otherwise;
    }
    bool flag(const char* key) const;  // false without it
    void numbers(const char* key, double* values, size_t count, double low, double high) const;
    // This number, and that of a member, as the index of an element of the document's `array`.
    size_t index(const char* array, size_t available) const;
    size_t reference(const char* key, const char* array, size_t available) const {
        return (*this)[key].index(array, available);
    }
    // Of the root: the element of `array` that `owner.key` refers to.
    GltfValue element(const char* array, const GltfValue& owner, const char* key) const {
        return (*this)[array][owner.reference(key, array, count(array))];
    }

  private:
    double anyNumber() const;

    const std::string* file_;
    const nlohmann::json* json_;
    std::string where_;
};

class GltfDocument {
  public:
    GltfDocument(const std::string& path, const std::string& bytes, const GltfResource& resource);

    GltfValue root() const { return GltfValue(path_, *json_, ""); }
    const std::string& path() const { return path_; }

    // The accessor that `owner.key` refers to: `components` numbers per element (1 to 4, or the 16 of a
    // matrix), normalised integers as fractions.
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
    struct Component;

    std::string resource(const GltfValue& value) const;  // what a "uri" names
    Span view(const GltfValue& owner, const char* key) const;
    std::vector<double> elements(const GltfValue& owner, uint64_t count, const Component& kind,
                                 uint64_t components) const;
    std::vector<double> numbers(const GltfValue& owner, const char* key, size_t components) const;

    std::string path_;
    const GltfResource& resource_;
    std::shared_ptr<const nlohmann::json> json_;
    std::string binary_;                // the chunk of a .glb
    std::vector<std::string> buffers_;  // of the document
    mutable double decodedBytes_ = 0;
};

}  // namespace pellucid::io
