// Reads PLY files [Turk 1994]. OpenMesh's reader fails, for example, at lists in vertices.
#include <algorithm>
#include <bit>

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
        for (const Property& p : properties)
            if (p.name == property) return &p;
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
    for (const Type& t : types)
        if (name == t.name || name == t.otherName) return &t;
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
        if (list.count->isFloat)
            scan.fail("the lengths of a list are whole numbers, of a type such as uchar");
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
        const auto same = [&](const Element& other) { return other.name == e.name; };
        if (std::count_if(header.elements.begin(), header.elements.end(), same) > 1)
            throw FileError(path, "announces the element " + e.name + " twice", e.line);
        if (e.properties.empty() && e.count > 0)
            throw FileError(path, "element " + e.name + " has no properties", e.line);
        if (e.name == "vertex") {
            vertices = true;
            for (const char* axis : {"x", "y", "z"}) {
                const Property* p = e.find(axis);
                if (!p || p->count || !p->type->isFloat)
                    throw FileError(path, std::string("vertices need '") + axis + "' as one float or double",
                                    e.line);
            }
        }
        if (e.name == "face") {
            faces = true;
            const Property* p = e.find("vertex_indices");
            if (!p) p = e.find("vertex_index");
            if (!p || !p->count || p->type->isFloat || p->count->isFloat)
                throw FileError(path, "faces need a list of whole numbers named vertex_indices", e.line);
        }
    }
    if (!vertices) throw FileError(path, "has no element 'vertex'");
    if (!faces) throw FileError(path, "has no element 'face'; a surface was expected");
}

// The values of a binary body, one after the other.
class BinaryBody {
  public:
    BinaryBody(const std::string& path, const std::string& text, const Header& header)
        : path_(path), text_(text), at_(header.bytes), swap_(header.encoding == Encoding::BigEndian) {}

    void begin(const Element&, long long) {}
    void end(const Element&) {}
    void skip(size_t count, const Property& p) { take(count, *p.type); }
    // A list's length.
    size_t length(const Property& p) {
        const uint64_t value = bits(*p.count);
        if (p.count->isSigned && value >> (8 * p.count->bytes - 1))
            throw FileError(path_, "has a list of negative length");
        return value;
    }
    double number(const Property& p) {
        const Type& type = *p.type;
        const uint64_t value = bits(type);
        if (type.isFloat)
            return type.bytes == 8 ? std::bit_cast<double>(value)
                                   : double(std::bit_cast<float>(uint32_t(value)));
        const int unused = 64 - 8 * int(type.bytes);
        return type.isSigned ? double(int64_t(value << unused) >> unused) : double(value);
    }

  private:
    void take(size_t count, const Type& type) {
        if (count > (text_.size() - at_) / type.bytes)
            throw FileError(path_, "ends early: the header announces more than the file holds");
        at_ += count * type.bytes;
    }
    uint64_t bits(const Type& type) {
        take(1, type);
        uint64_t value = 0;
        for (size_t i = 0; i < type.bytes; ++i) {
            const size_t from = swap_ ? i : type.bytes - 1 - i;
            value = value << 8 | static_cast<unsigned char>(text_[at_ - type.bytes + from]);
        }
        return value;
    }

    const std::string& path_;
    const std::string& text_;
    size_t at_;
    bool swap_;
};

// The values of a text body, which has a line per element.
class AsciiBody {
  public:
    AsciiBody(const std::string& path, const std::string& text, const Header& header)
        : scan_(path, std::string_view(text).substr(header.bytes), '\n', header.lines) {}

    void begin(const Element& e, long long i) {
        if (!scan_.nextLine())
            scan_.fail(concat("ends early: ", e.count, " of element ", e.name, " announced, ", i, " found"));
        word_ = 0;
    }
    void end(const Element& e) const {
        if (word_ != scan_.words().size())
            scan_.fail(concat("has ", scan_.words().size(), " values; the header announces ", word_,
                              " for each ", e.name));
    }
    size_t length(const Property& p) {
        const long long length = scan_.integer(word(), "length of " + p.name);
        ++word_;
        const size_t left = scan_.words().size() - word_;
        if (length < 0 || size_t(length) > left)
            scan_.fail(concat("the list ", p.name, " announces ", length, " values and has ", left));
        return size_t(length);
    }
    double number(const Property& p) {
        const double value =
            p.type->isFloat ? double(scan_.number(word_, p.name)) : double(scan_.integer(word(), p.name));
        ++word_;
        return value;
    }
    void skip(size_t count, const Property&) { word_ += count; }

  private:
    std::string_view word() const {
        return word_ < scan_.words().size() ? scan_.words()[word_] : std::string_view();
    }
    TextScan scan_;
    size_t word_ = 0;
};

// Names of the vertex properties that are used.
constexpr std::string_view vertexNames[][3] = {
    {"x"}, {"y"}, {"z"}, {"nx"}, {"ny"}, {"nz"}, {"u", "s", "texture_u"}, {"v", "t", "texture_v"}};
constexpr size_t firstNormal = 3, firstUv = 6, vertexValues = 8;

bool isIndices(const Property& p) {
    return p.count && !p.type->isFloat && (p.name == "vertex_indices" || p.name == "vertex_index");
}

template <class Body>
void readVertices(Body& body, const Element& e, RawMesh& mesh) {
    std::vector<size_t> role(e.properties.size(), vertexValues);
    bool has[vertexValues] = {};
    for (size_t k = 0; k < e.properties.size(); ++k)
        for (size_t r = 0; r < vertexValues; ++r)
            for (std::string_view name : vertexNames[r])
                if (!e.properties[k].count && !has[r] && e.properties[k].name == name) {
                    role[k] = r;
                    has[r] = true;
                    break;
                }
    const bool normals = has[3] && has[4] && has[5], uvs = has[6] && has[7];
    for (long long i = 0; i < e.count; ++i) {
        body.begin(e, i);
        float values[vertexValues] = {};
        for (size_t k = 0; k < e.properties.size(); ++k) {
            const Property& p = e.properties[k];
            if (role[k] < vertexValues)
                values[role[k]] = float(body.number(p));
            else
                body.skip(p.count ? body.length(p) : 1, p);
        }
        body.end(e);
        mesh.positions.insert(mesh.positions.end(), values, values + 3);
        if (normals) mesh.normals.insert(mesh.normals.end(), values + firstNormal, values + firstUv);
        if (uvs) mesh.uvs.insert(mesh.uvs.end(), values + firstUv, values + vertexValues);
    }
}

template <class Body>
void readFaces(Body& body, const Element& e, RawMesh& mesh) {
    for (long long i = 0; i < e.count; ++i) {
        body.begin(e, i);
        bool seen = false;
        for (const Property& p : e.properties) {
            const size_t length = p.count ? body.length(p) : 1;
            if (seen || !isIndices(p)) {
                body.skip(length, p);
                continue;
            }
            seen = true;
            constexpr double most = 1e15;  // an int64_t holds it; no vertex has such an index
            for (size_t k = 0; k < length; ++k)
                mesh.corners.push_back(int64_t(std::clamp(body.number(p), -most, most)));
        }
        body.end(e);
        mesh.faceStart.push_back(uint32_t(mesh.corners.size()));
    }
}

template <class Body>
void readElements(Body body, const Header& header, RawMesh& mesh) {
    for (const Element& e : header.elements) {
        if (e.name == "vertex") {
            readVertices(body, e, mesh);
        } else if (e.name == "face") {
            readFaces(body, e, mesh);
        } else {
            for (long long i = 0; i < e.count; ++i) {
                body.begin(e, i);
                for (const Property& p : e.properties) body.skip(p.count ? body.length(p) : 1, p);
                body.end(e);
            }
        }
    }
}

}  // namespace

RawMesh readPly(const std::string& path, const std::string& text) {
    const Header header = readHeader(path, text);
    checkElements(path, header);
    RawMesh mesh;
    if (header.encoding == Encoding::Ascii)
        readElements(AsciiBody(path, text, header), header, mesh);
    else
        readElements(BinaryBody(path, text, header), header, mesh);
    return mesh;
}

}  // namespace pellucid::io
