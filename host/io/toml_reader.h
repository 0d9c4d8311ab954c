// Reads one TOML table key by key. Keys that nobody asked for are errors.
#pragma once

// Damaged text breaks some of toml++'s assertions, which NDEBUG has the compiler take for granted; the checks behind them say what
// is wrong with the text.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expr) static_cast<void>(0)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/file_error.h"
#include "io/scene/scene_keys.h"

namespace pellucid::io {

// Throws FileError with the line if keys have more than 16 parts or brackets nest more than 16 deep.
void checkTomlDepth(const std::string& file, std::string_view text);

// Parses the text of `file`. Throws FileError with the line if it is not TOML, nests too deep, or has more
// than textLimit bytes.
toml::table parseToml(const std::string& file, const std::string& text);

class TomlReader {
  public:
    // `where` names the table in messages: "[[light]]", or "the scene" for the whole file.
    TomlReader(std::string file, const toml::table& table, std::string where)
        : file_(std::move(file)), table_(table), where_(std::move(where)) {}

    void number(std::string_view key, float& value, Range range);
    void numbers(std::string_view key, float* values, size_t count, Range range);
    void rows(std::string_view key, float* values, size_t rows, size_t columns);
    void integer(std::string_view key, uint32_t& value, Range range);
    void text(std::string_view key, std::string& value);
    // From `least` to `most` of them. One text is enough for 1.
    void texts(std::string_view key, std::vector<std::string>& values, size_t most, size_t least);

    // One value or an array of them, not empty.
    void list(std::string_view key, std::vector<std::string>& values);
    void list(std::string_view key, std::vector<float>& values, Range range);

    template <class Enum>
    void choice(std::string_view key, Enum& value, std::span<const std::string_view> names) {
        uint32_t index = static_cast<uint32_t>(value);
        choiceIndex(key, index, names);
        value = static_cast<Enum>(index);
    }
    template <class Function>
    void table(std::string_view key, bool, Function&& function) {
        if (const toml::table* inner = subTable(key)) {
            TomlReader reader(file_, *inner, innerName(key));
            function(reader);
            reader.finish();
        }
    }

    // The tables [[key]], in order. Each is passed to `function(reader)` and then finished.
    void tables(std::string_view key, const std::function<void(TomlReader&)>& function);

    // The same, but errors in one table go to `failed`, and the others are still read.
    void tablesApart(std::string_view key, const std::function<void(TomlReader&)>& function,
                     const std::function<void(const FileError&)>& failed);

    // The rule of every format here: `version` may be left out and is 1 then; a later one than this program knows is an error.
    int64_t version(int64_t known = 1);

    void finish() const;  // throws FileError for the first key that nobody asked for
    int line() const { return static_cast<int>(table_.source().begin.line); }
    int lineOf(std::string_view key) const;
    bool has(std::string_view key) const { return table_.contains(key); }
    [[noreturn]] void fail(std::string_view key, const std::string& message) const;

  private:
    const toml::node* find(std::string_view key);  // marks the key as known
    float toFloat(std::string_view key, const toml::node& node, Range range) const;
    void choiceIndex(std::string_view key, uint32_t& index, std::span<const std::string_view> names);
    const toml::table* subTable(std::string_view key);
    std::string innerName(std::string_view key) const;

    std::string file_;
    const toml::table& table_;
    std::string where_;
    std::vector<std::string> known_;
};

}  // namespace pellucid::io
