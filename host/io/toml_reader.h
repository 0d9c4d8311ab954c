// Reads one TOML table key by key; a key that was not read is an error. toml++ is included by
// toml_reader.cpp alone, because its header takes seconds to compile.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "fields/field_ranges.h"
#include "io/file_error.h"

namespace pellucid::io {

using Range = pel::FieldRange;
namespace range = pel::range;

struct TomlTable;  // an opaque toml::table

// Throws FileError with the line if the text is not TOML, nests too deep, or has over textLimit bytes.
std::shared_ptr<const TomlTable> parseToml(const std::string& file, const std::string& text);

class TomlReader {
  public:
    // `where` names the table in messages: "[[light]]", or "the scene" for the whole file.
    TomlReader(std::string file, const TomlTable& table, std::string where)
        : file_(std::move(file)), table_(table), where_(std::move(where)) {}

    void number(std::string_view key, float& value, Range range);
    void numbers(std::string_view key, float* values, size_t count, Range range);
    void rows(std::string_view key, float* values, size_t rows, size_t columns);
    void integer(std::string_view key, uint32_t& value, Range range);
    void text(std::string_view key, std::string& value);
    // From `least` to `most` of them. One text is enough for 1.
    void texts(std::string_view key, std::vector<std::string>& values, size_t most, size_t least,
               std::string_view of = "channel name");

    // One value or an array of them, not empty.
    void list(std::string_view key, std::vector<std::string>& values);
    void list(std::string_view key, std::vector<float>& values, Range range);

    template <class Enum>
    void choice(std::string_view key, Enum& value, std::span<const std::string_view> names) {
        uint32_t index = uint32_t(value);
        choiceIndex(key, index, names);
        value = static_cast<Enum>(index);
    }
    template <class Function>
    void table(std::string_view key, bool, Function&& function) {
        if (const TomlTable* inner = subTable(key)) {
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

    // `version` may be left out and is 1 then; a later version than `known` is an error.
    int64_t version(int64_t known = 1);

    void finish() const;  // throws FileError for the first key that was not read
    int line() const;
    int lineOf(std::string_view key) const;
    bool has(std::string_view key) const;
    [[noreturn]] void fail(std::string_view key, const std::string& message) const;

  private:
    struct Nodes;  // helpers that use the types of toml++
    void choiceIndex(std::string_view key, uint32_t& index, std::span<const std::string_view> names);
    const TomlTable* subTable(std::string_view key);
    std::string innerName(std::string_view key) const;

    std::string file_;
    const TomlTable& table_;
    std::string where_;
    std::vector<std::string> known_;
};

}  // namespace pellucid::io
