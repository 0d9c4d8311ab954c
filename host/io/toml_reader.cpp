#include "io/toml_reader.h"

// Damaged text violates some of toml++'s assertions, which the compiler takes as given under NDEBUG; the
// checks behind them report the fault in the text.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(expr) static_cast<void>(0)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include <algorithm>
#include <cmath>

#include "io/input_file.h"
#include "io/spelling.h"

namespace pellucid::io {
namespace {

std::string typeName(const toml::node& node) {
    std::ostringstream text;
    const bool vowel = node.is_array() || node.is_integer();
    text << (vowel ? "an " : "a ") << node.type();
    return text.str();
}

std::string inQuotes(std::string_view text) {
    return concat("'", text, "'");
}

const toml::table& nodesOf(const TomlTable& table) {
    return reinterpret_cast<const toml::table&>(table);
}

const TomlTable* opaque(const toml::table* table) {
    return reinterpret_cast<const TomlTable*>(table);
}

}  // namespace

struct TomlReader::Nodes {
    // Marks the key as known.
    static const toml::node* find(TomlReader& reader, std::string_view key) {
        reader.known_.emplace_back(key);
        return nodesOf(reader.table_).get(key);
    }

    // The value of `key` if it is there; it must be a T, in words `wanted`.
    template <class T>
    static auto find(TomlReader& reader, std::string_view key, const std::string& wanted) {
        const toml::node* node = find(reader, key);
        if (node && !node->is<T>())
            reader.fail(key, "is " + typeName(*node) + "; " + wanted + " would be right");
        return node ? node->as<T>() : nullptr;
    }

    // The same for an array of `count` elements.
    static const toml::array* array(TomlReader& reader, std::string_view key, size_t count,
                                    const std::string& wanted, const char* elements) {
        const auto* array = find<toml::array>(reader, key, wanted);
        if (array && array->size() != count)
            reader.fail(key, concat("has ", array->size(), " ", elements, "; ", wanted, " would be right",
                                    (count == 16 ? " (a matrix, row by row)" : "")));
        return array;
    }

    // Each element of an array that is not empty, or a single value; `use` reads one.
    template <class Use>
    static void each(TomlReader& reader, std::string_view key, Use&& use) {
        const toml::node* node = find(reader, key);
        if (!node) return;
        if (!node->is_array()) return use(*node);
        if (node->as_array()->empty()) reader.fail(key, "is empty; at least one value would be right");
        for (const toml::node& entry : *node->as_array()) use(entry);
    }

    static float toFloat(const TomlReader& reader, std::string_view key, const toml::node& node,
                         Range range) {
        if (!node.is_number()) reader.fail(key, "is " + typeName(node) + "; a number would be right");
        const auto value =
            float(node.is_integer() ? double(node.as_integer()->get()) : node.as_floating_point()->get());
        if (range.holds(value)) return value;
        std::ostringstream text;
        text << "is " << value << "; it must be " << describe(range);
        reader.fail(key, text.str());
    }
};

// toml++ limits brackets inside one another, but not the parts of a key. It makes and destroys a table for
// each part by recursion. Dots in strings and comments count too: real files do not have that many.
static void refuseLongKeys(const std::string& file, std::string_view text) {
    constexpr int mostParts = 1000;
    int line = 1, dots = 0;
    for (const char c : text) {
        if (std::string_view("[]{}=,\n").find(c) != std::string_view::npos) dots = 0;
        line += c == '\n';
        dots += c == '.';
        if (dots >= mostParts)
            throw FileError(file, concat("a key has more than ", mostParts, " parts"), line);
    }
}

std::shared_ptr<const TomlTable> parseToml(const std::string& file, const std::string& text) {
    if (text.size() > textLimit)
        throw FileError(file, concat("has ", text.size(), " bytes; TOML may have ", textLimit));
    refuseLongKeys(file, text);
    try {
        const auto root = std::make_shared<const toml::table>(toml::parse(text, file));
        return {root, opaque(root.get())};
    } catch (const toml::parse_error& error) {
        throw FileError(file, "is not TOML: " + std::string(error.description()),
                        int(error.source().begin.line));
    }
}

int TomlReader::line() const {
    return int(nodesOf(table_).source().begin.line);
}

bool TomlReader::has(std::string_view key) const {
    return nodesOf(table_).contains(key);
}

int TomlReader::lineOf(std::string_view key) const {
    for (const auto& [k, node] : nodesOf(table_)) {
        if (k.str() == key) return int(k.source().begin.line);
    }
    return line();
}

void TomlReader::fail(std::string_view key, const std::string& message) const {
    throw FileError(file_, inQuotes(key) + " in " + where_ + " " + message, lineOf(key));
}

int64_t TomlReader::version(int64_t known) {
    const std::string versions = known == 1 ? "1" : concat("1 to ", known);
    const auto* node = Nodes::find<int64_t>(*this, "version", versions);
    if (!node) return 1;
    const int64_t given = node->get();
    if (given < 1) fail("version", concat("is ", given, "; ", versions, " would be right"));
    if (given > known)
        fail("version", concat("is ", given, ", of a later pellucid; this one reads version ", versions));
    return given;
}

void TomlReader::number(std::string_view key, float& value, Range range) {
    if (const toml::node* node = Nodes::find(*this, key)) value = Nodes::toFloat(*this, key, *node, range);
}

void TomlReader::numbers(std::string_view key, float* values, size_t count, Range range) {
    const toml::array* array =
        Nodes::array(*this, key, count, concat("an array of ", count, " numbers"), "values");
    for (size_t i = 0; array && i < count; ++i) values[i] = Nodes::toFloat(*this, key, (*array)[i], range);
}

void TomlReader::rows(std::string_view key, float* values, size_t rows, size_t columns) {
    const std::string wanted = concat(rows, " arrays of ", columns, " numbers");
    const toml::array* array = Nodes::array(*this, key, rows, wanted, "rows");
    for (size_t r = 0; array && r < rows; ++r) {
        const toml::array* row = (*array)[r].as_array();
        if (!row || row->size() != columns)
            fail(key, concat("has a row ", r, " (counted from 0) that is not an array of ", columns, "; ",
                             wanted, " would be right"));
        for (size_t c = 0; c < columns; ++c)
            values[r * columns + c] = Nodes::toFloat(*this, key, (*row)[c], range::any);
    }
}

void TomlReader::integer(std::string_view key, uint32_t& value, Range range) {
    const uint32_t low = uint32_t(range.min), high = range.max < 0x1p32f ? uint32_t(range.max) : UINT32_MAX;
    const std::string special = std::isnan(range.special) ? "" : concat(uint32_t(range.special), ", or "),
                      wanted = concat(special, "a whole number from ", low, " to ", high);
    const auto* node = Nodes::find<int64_t>(*this, key, wanted);
    if (!node) return;
    const int64_t given = node->get();
    if ((given < low || given > high) && (special.empty() || given != int64_t(range.special)))
        fail(key, concat("is ", given, "; it must be ", wanted));
    value = uint32_t(given);
}

void TomlReader::text(std::string_view key, std::string& value) {
    const auto* node = Nodes::find<std::string>(*this, key, "a string in quotes");
    if (!node) return;
    value = node->get();
    if (value.find('\0') != std::string::npos) fail(key, "holds a NUL character");
}

void TomlReader::texts(std::string_view key, std::vector<std::string>& values, size_t most, size_t least,
                       std::string_view of) {
    const toml::node* node = Nodes::find(*this, key);
    if (!node) return;
    const std::string wanted = most == 1      ? concat("one ", of)
                               : least < most ? concat("an array of ", least, " to ", most, " ", of, "s")
                                              : concat("an array of ", most, " ", of, "s");
    values.clear();
    if (node->is_string() && least == 1) {
        values.push_back(node->as_string()->get());
        return;
    }
    if (!node->is_array()) fail(key, "is " + typeName(*node) + "; " + wanted + " would be right");
    for (const toml::node& entry : *node->as_array()) {
        if (!entry.is_string()) fail(key, "holds " + typeName(entry) + "; " + wanted + " would be right");
        values.push_back(entry.as_string()->get());
    }
    if (values.size() > most || values.size() < least)
        fail(key, concat("has ", values.size(), " names; ", wanted, " would be right"));
}

void TomlReader::choiceIndex(std::string_view key, uint32_t& index, std::span<const std::string_view> names) {
    std::string given;
    text(key, given);
    if (!has(key)) return;
    const auto found = std::ranges::find(names, given);
    index = uint32_t(found - names.begin());
    if (found != names.end()) return;
    std::vector<std::string> quoted;
    for (std::string_view name : names) quoted.push_back(inQuotes(name));
    fail(key, "is " + inQuotes(given) + "; one of " + joined(quoted) + " would be right");
}

const TomlTable* TomlReader::subTable(std::string_view key) {
    return opaque(Nodes::find<toml::table>(*this, key, "a table"));
}

std::string TomlReader::innerName(std::string_view key) const {
    std::string name = where_;  // "[[light]]" to "[light.shadow_map]"
    std::erase_if(name, [](char c) { return c == '[' || c == ']'; });
    return where_.front() == '[' ? concat("[", name, ".", key, "]") : concat("[", key, "]");
}

void TomlReader::list(std::string_view key, std::vector<std::string>& values) {
    std::vector<std::string> found;
    Nodes::each(*this, key, [&](const toml::node& entry) {
        if (!entry.is_string())
            fail(key, "holds " + typeName(entry) + "; a string or an array of strings would be right");
        found.push_back(entry.as_string()->get());
    });
    if (!found.empty()) values = std::move(found);
}

void TomlReader::list(std::string_view key, std::vector<float>& values, Range range) {
    std::vector<float> found;
    Nodes::each(*this, key,
                [&](const toml::node& entry) { found.push_back(Nodes::toFloat(*this, key, entry, range)); });
    if (!found.empty()) values = std::move(found);
}

void TomlReader::tables(std::string_view key, const std::function<void(TomlReader&)>& function) {
    tablesApart(key, function, [](const FileError& error) { throw error; });
}

void TomlReader::tablesApart(std::string_view key, const std::function<void(TomlReader&)>& function,
                             const std::function<void(const FileError&)>& failed) {
    const std::string name = "[[" + std::string(key) + "]]";
    const auto* array = Nodes::find<toml::array>(*this, key, "tables that start with " + name);
    if (!array) return;
    for (const toml::node& entry : *array) {
        if (!entry.is_table()) fail(key, "holds " + typeName(entry) + "; tables " + name + " would be right");
        TomlReader reader(file_, *opaque(entry.as_table()), name);
        try {
            function(reader);
            reader.finish();
        } catch (const FileError& error) {
            failed(error);
        }
    }
}

void TomlReader::finish() const {
    for (const auto& [key, node] : nodesOf(table_)) {
        const std::string_view given = key.str();
        if (std::find(known_.begin(), known_.end(), given) != known_.end()) continue;
        const std::string nearest = nearestWord(given, known_);
        const std::string list = joined(known_);
        fail(given, nearest.empty() ? "is not known; known: " + list
                                    : "is not known; did you mean " + inQuotes(nearest) + "? Known: " + list);
    }
}

}  // namespace pellucid::io
