// A walk through a PLY file [Turk 1994] before OpenMesh sees it: the header word by word, then every value
// that the header announces.
#include <bit>
#include <cstdint>

#include "io/mesh/mesh_text.h"
#include "io/text_scan.h"

namespace pellucid::io {
namespace {

enum class Encoding { Ascii, LittleEndian, BigEndian };

struct Type {
    std::string_view name, otherName;
    size_t bytes;
    bool isFloat, isSigned;
};
constexpr Type types[] = {{"char", "int8", 1, false, true},    {"uchar", "uint8", 1, false, false},
                          {"short", "int16", 2, false, true},  {"ushort", "uint16", 2, false, false},
                          {"int", "int32", 4, false, true},    {"uint", "uint32", 4, false, false},
                          {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true}};

struct Property {
    std::string name;
    const Type* type = nullptr;   // of the values
    const Type* count = nullptr;  // of a list's length; nullptr: one value
};

struct Element {
    std::string name;
    long long count = 0;
    std::vector<Property> properties;
    int line = 0;
    const Property* find(std::string_view property) const {
        for (const Property& p : properties) {
            if (p.name == property) return &p;
        }
        return nullptr;
    }
};

struct Header {
    Encoding encoding = Encoding::Ascii;
    std::vector<Element> elements;
    size_t bytes = 0;  // header lines, end_header and its line break included
    int lines = 0;
};

const Type* typeNamed(const TextScan& scan, std::string_view name) {
    for (const Type& t : types) {
        if (name == t.name || name == t.otherName) return &t;
    }
    scan.fail("has the type '" + std::string(name) +
              "'; char, uchar, short, ushort, int, uint, float and double are known");
}

Encoding encodingOf(const TextScan& scan) {
    if (scan.words().size() != 3 || scan.words()[2] != "1.0")
        scan.fail("'format ENCODING 1.0' would be right");
    const std::string_view word = scan.words()[1];
    if (word == "ascii") return Encoding::Ascii;
    if (word == "binary_little_endian") return Encoding::LittleEndian;
    if (word == "binary_big_endian") return Encoding::BigEndian;
    scan.fail("has the format '" + std::string(word) +
              "'; ascii, binary_little_endian and binary_big_endian are known");
}

Property propertyOf(const TextScan& scan) {
    const auto& words = scan.words();
    if (words.size() == 5 && words[1] == "list") {
        const Property list{std::string(words[4]), typeNamed(scan, words[3]), typeNamed(scan, words[2])};
        if (list.count->isFloat) scan.fail("the lengths of a list are whole numbers, of a type such as uchar");
        return list;
    }
    if (words.size() != 3) scan.fail("'property TYPE NAME' or 'property list TYPE TYPE NAME' would be right");
    return {std::string(words[2]), typeNamed(scan, words[1]), nullptr};
}

Header readHeader(const std::string& path, const std::string& text) {
    const size_t before = text.find("\nend_header");
    const size_t end = before == std::string::npos ? before : before + 1;
    const size_t lineEnd = end == std::string::npos ? end : text.find('\n', end);
    if (text.rfind("ply", 0) != 0) throw FileError(path, "does not start with 'ply'", 1);
    if (lineEnd == std::string::npos) throw FileError(path, "has no line 'end_header': the file was cut off");
    if (text.find_first_not_of(" \t\r", end + 10) != lineEnd)
        throw FileError(path, "has more than 'end_header' in that line");
    Header header;
    header.bytes = lineEnd + 1;
    TextScan scan(path, std::string_view(text).substr(0, end), '\n');
    scan.nextLine();
    if (scan.words().size() != 1 || scan.words()[0] != "ply")
        scan.fail("the first line of a PLY file is 'ply'");
    bool format = false;
    while (scan.nextLine()) {
        const std::string_view word = scan.words()[0];
        if (word == "comment" || word == "obj_info") continue;
        if (word == "format") {
            header.encoding = encodingOf(scan);
            format = true;
        } else if (word == "element") {
            if (scan.words().size() != 3) scan.fail("'element NAME COUNT' would be right");
            header.elements.push_back(
                {std::string(scan.words()[1]), scan.integer(scan.words()[2], "number"), {}, scan.line()});
            if (header.elements.back().count < 0) scan.fail("the number of elements cannot be negative");
        } else if (word == "property") {
            if (header.elements.empty()) scan.fail("a property needs an element before it");
            header.elements.back().properties.push_back(propertyOf(scan));
        } else {
            scan.fail("starts with '" + std::string(word) +
                      "'; format, element, property and comment are known");
        }
    }
    if (!format) throw FileError(path, "has no line 'format'; 'format ascii 1.0' would be right for text", 1);
    header.lines = scan.line() + 1;
    return header;
}

void checkElements(const std::string& path, const Header& header) {
    bool vertices = false, faces = false;
    for (const Element& e : header.elements) {
        if (e.properties.empty() && e.count > 0)
            throw FileError(path, "element " + e.name + " has no properties", e.line);
        if (e.name == "vertex") {
            vertices = true;
            for (const char* axis : {"x", "y", "z"}) {
                const Property* p = e.find(axis);
                if (!p || p->count || !p->type->isFloat) {
                    throw FileError(path, std::string("vertices need '") + axis + "' as one float or double",
                                    e.line);
                }
            }
        }
        if (e.name == "face") {
            if (!vertices)
                throw FileError(path, "faces stand before the vertices; OpenMesh needs them after", e.line);
            faces = true;
            const Property* p = e.find("vertex_indices");
            if (!p) p = e.find("vertex_index");
            if (!p || !p->count || p->type->isFloat || p->count->isFloat) {
                throw FileError(path, "faces need a list of whole numbers named vertex_indices", e.line);
            }
        }
    }
    if (!vertices) throw FileError(path, "has no element 'vertex'");
    if (!faces) throw FileError(path, "has no element 'face'; a surface was expected");
}

// The values of a binary body, one after the other.
class Body {
  public:
    Body(const std::string& path, const std::string& text, const Header& header)
        : path_(path), text_(text), at_(header.bytes), swap_(header.encoding == Encoding::BigEndian) {}

    void skip(size_t count, const Type& type) {
        if (count > (text_.size() - at_) / type.bytes) fail();
        at_ += count * type.bytes;
    }
    // A list's length.
    size_t length(const Type& type) {
        skip(1, type);
        uint64_t value = 0;
        for (size_t i = 0; i < type.bytes; ++i) {
            const size_t from = swap_ ? i : type.bytes - 1 - i;
            value = value << 8 | static_cast<unsigned char>(text_[at_ - type.bytes + from]);
        }
        if (type.isSigned && value >> (8 * type.bytes - 1)) throw FileError(path_, "has a list of negative length");
        return value;
    }

  private:
    [[noreturn]] void fail() const {
        throw FileError(path_, "ends early: the header announces more than the file holds");
    }

    const std::string& path_;
    const std::string& text_;
    size_t at_;
    bool swap_;
};

void checkBinary(const std::string& path, const std::string& text, const Header& header) {
    static_assert(std::endian::native == std::endian::little);
    Body body(path, text, header);
    for (const Element& e : header.elements) {
        for (long long i = 0; i < e.count; ++i) {
            for (const Property& p : e.properties) body.skip(p.count ? body.length(*p.count) : 1, *p.type);
        }
    }
}

void checkAscii(const std::string& path, const std::string& text, const Header& header) {
    TextScan scan(path, std::string_view(text).substr(header.bytes), '\n', header.lines);
    for (const Element& e : header.elements) {
        for (long long i = 0; i < e.count; ++i) {
            if (!scan.nextLine()) {
                scan.fail("ends early: " + std::to_string(e.count) + " of element " + e.name +
                          " announced, " + std::to_string(i) + " found");
            }
            size_t word = 0;
            for (const Property& p : e.properties) {
                size_t values = 1;
                if (p.count) {
                    const std::string_view first =
                        word < scan.words().size() ? scan.words()[word] : std::string_view();
                    const long long length = scan.integer(first, "length of " + p.name);
                    ++word;
                    if (length < 0 || static_cast<size_t>(length) > scan.words().size() - word) {
                        scan.fail("the list " + p.name + " announces " + std::to_string(length) +
                                  " values and has " + std::to_string(scan.words().size() - word));
                    }
                    values = static_cast<size_t>(length);
                }
                for (size_t v = 0; v < values; ++v, ++word) {
                    if (p.type->isFloat) {
                        scan.number(word, p.name);
                    } else {
                        scan.integer(word < scan.words().size() ? scan.words()[word] : std::string_view(),
                                     p.name);
                    }
                }
            }
            if (word != scan.words().size()) {
                scan.fail("has " + std::to_string(scan.words().size()) + " values; the header announces " +
                          std::to_string(word) + " for each " + e.name);
            }
        }
    }
}

// The header as this program would write it: OpenMesh's reader of headers trips over what it does not expect.
std::string canonicalHeader(const Header& header) {
    constexpr const char* encodings[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    std::string out =
        std::string("ply\nformat ") + encodings[static_cast<size_t>(header.encoding)] + " 1.0\n";
    for (const Element& e : header.elements) {
        out += "element " + e.name + ' ' + std::to_string(e.count) + '\n';
        for (const Property& p : e.properties) {
            out += "property ";
            if (p.count) out.append("list ").append(p.count->name) += ' ';
            out.append(p.type->name).append(" ").append(p.name) += '\n';
        }
    }
    return out + "end_header\n";
}

}  // namespace

MeshText checkPly(const std::string& path, const std::string& text) {
    const Header header = readHeader(path, text);
    checkElements(path, header);
    if (header.encoding == Encoding::Ascii) {
        checkAscii(path, text, header);
    } else {
        checkBinary(path, text, header);
    }
    MeshText result;
    for (const Element& e : header.elements) {
        if (e.name == "face") result.faces += static_cast<size_t>(e.count);
    }
    const std::string written = canonicalHeader(header);
    if (text.compare(0, header.bytes, written) != 0) result.canonical = written + text.substr(header.bytes);
    return result;
}

}  // namespace pellucid::io
