// Writes TOML files.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "fields/field_ranges.h"
#include "io/shortest.h"

namespace pellucid::io {

// Writes keys as the visitor that io/scene/scene_keys.h describes.
class TomlWriter {
  public:
    explicit TomlWriter(std::string& out, std::string name = "") : out_(out), name_(std::move(name)) {}

    void number(std::string_view key, float value, const pel::FieldRange& range) {
        if (!(value == range.special && value < 0)) line(key, shortest(value));
    }
    // If all values are the special one they mean the default, and the key is left out.
    void numbers(std::string_view key, const float* values, size_t count, const pel::FieldRange& range) {
        if (!std::all_of(values, values + count, [&](float v) { return v == range.special; }))
            line(key, shown(values, count));
    }
    void rows(std::string_view key, const float* values, size_t rows, size_t columns) {
        std::string text = "[\n";
        for (size_t r = 0; r < rows; ++r) text += "    " + shown(values + r * columns, columns) + ",\n";
        line(key, text + "]");
    }
    void integer(std::string_view key, uint32_t value, const pel::FieldRange&) {
        line(key, std::to_string(value));
    }
    void text(std::string_view key, const std::string& value) {
        if (!value.empty()) line(key, quoted(value));
    }
    void texts(std::string_view key, const std::vector<std::string>& values, size_t, size_t,
               std::string_view = "") {
        if (values.empty()) return;
        std::string list;
        for (const std::string& value : values) list += (list.empty() ? "" : ", ") + quoted(value);
        line(key, values.size() == 1 ? list : "[" + list + "]");
    }
    template <class Enum>
    void choice(std::string_view key, Enum value, std::span<const std::string_view> names) {
        line(key, quoted(names[size_t(value)]));
    }
    template <class Function>
    void table(std::string_view key, bool isPresent, Function&& function) {
        if (!isPresent) return;
        TomlWriter inner(out_, name_ + "." + std::string(key));
        out_ += "\n[" + inner.name_ + "]\n";
        function(inner);
    }

    static std::string quoted(std::string_view text) {
        constexpr char hex[] = "0123456789ABCDEF";
        std::string out = "\"";
        for (const char c : text) {
            const auto byte = static_cast<unsigned char>(c);
            if (byte < 0x20 || byte == 0x7f) {
                ((out += "\\u00") += hex[byte >> 4]) += hex[byte & 15];
            } else {
                if (c == '"' || c == '\\') out += '\\';
                out += c;
            }
        }
        return out + "\"";
    }

  private:
    void line(std::string_view key, const std::string& value) {
        out_.append(key).append(" = ").append(value) += '\n';
    }

    static std::string shown(const float* values, size_t count) {
        std::string list;
        for (size_t i = 0; i < count; ++i) list += (i ? ", " : "") + shortest(values[i]);
        return "[" + list + "]";
    }
    std::string& out_;
    std::string name_;
};

}  // namespace pellucid::io
