// A value of a glTF's JSON with its location in the file, which every message names.
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "io/file_error.h"

namespace pellucid::io {

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
    size_t count(const char* key) const;
    // The extension NAME of this object; call hasExtension first.
    bool hasExtension(const char* name) const;
    GltfValue extension(const char* name) const;

    size_t size() const;  // of an array
    double number(double low, double high) const;
    uint64_t whole(uint64_t most) const;  // 0 to `most`
    const std::string& text() const;
    const std::string& where() const { return where_; }

    // Of a member, or `otherwise` if it is not there.
    double number(const char* key, double otherwise, double low, double high) const;
    uint64_t whole(const char* key, uint64_t otherwise, uint64_t most) const;
    std::string text(const char* key, const std::string& otherwise) const;
    bool flag(const char* key) const;  // false without it
    void numbers(const char* key, double* values, size_t count, double low, double high) const;
    // The index of an element of the document's `array`, which must have it.
    size_t reference(const char* key, const char* array, size_t available) const;

  private:
    double anyNumber() const;

    const std::string* file_;
    const nlohmann::json* json_;
    std::string where_;
};

}  // namespace pellucid::io
