#include "gltf/gltf_document.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/input_file.h"

namespace pellucid::io {

void GltfValue::fail(const std::string& message) const {
    throw FileError(*file_, (where_.empty() ? "the scene" : where_) + " " + message);
}

bool GltfValue::has(const char* key) const {
    return json_->is_object() && json_->contains(key);
}

GltfValue GltfValue::operator[](const char* key) const {
    if (!json_->is_object()) fail("is no object");
    const auto at = json_->find(key);
    if (at == json_->end()) fail(std::string("has no '") + key + "'");
    return GltfValue(*file_, *at, where_.empty() ? key : where_ + "." + key);
}

GltfValue GltfValue::operator[](size_t index) const {
    return GltfValue(*file_, (*json_)[index], where_ + "[" + std::to_string(index) + "]");
}

size_t GltfValue::count(const char* key) const {
    return has(key) ? (*this)[key].size() : 0;
}

bool GltfValue::hasExtension(const char* name) const {
    return has("extensions") && (*this)["extensions"].has(name);
}

GltfValue GltfValue::extension(const char* name) const {
    return (*this)["extensions"][name];
}

size_t GltfValue::size() const {
    if (!json_->is_array()) fail("is no array");
    return json_->size();
}

double GltfValue::anyNumber() const {
    if (!json_->is_number()) fail("is not a number");
    return json_->get<double>();
}

double GltfValue::number(double low, double high) const {
    const double value = anyNumber();
    if (value >= low && value <= high) return value;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "is " << value << "; " << low << " to " << high << " is possible";
    fail(text.str());
}

uint64_t GltfValue::whole(uint64_t most) const {
    const double value = anyNumber();  // some programs write whole numbers with a point
    if (!(value >= 0 && value <= double(most)) || value != std::floor(value))
        fail("is " + json_->dump() + "; a whole number from 0 to " + std::to_string(most) +
             " would be right");
    return uint64_t(value);
}

const std::string& GltfValue::text() const {
    if (!json_->is_string()) fail("is no text");
    return json_->get_ref<const std::string&>();
}

double GltfValue::number(const char* key, double otherwise, double low, double high) const {
    return has(key) ? (*this)[key].number(low, high) : otherwise;
}

uint64_t GltfValue::whole(const char* key, uint64_t otherwise, uint64_t most) const {
    return has(key) ? (*this)[key].whole(most) : otherwise;
}

std::string GltfValue::text(const char* key, const std::string& otherwise) const {
    return has(key) ? (*this)[key].text() : otherwise;
}

bool GltfValue::flag(const char* key) const {
    if (!has(key)) return false;
    const GltfValue value = (*this)[key];
    if (!value.json_->is_boolean()) value.fail("is neither true nor false");
    return value.json_->get<bool>();
}

void GltfValue::numbers(const char* key, double* values, size_t count, double low, double high) const {
    if (!has(key)) return;
    const GltfValue list = (*this)[key];
    if (list.size() != count)
        list.fail("has " + std::to_string(list.size()) + " values; " + std::to_string(count) +
                  " would be right");
    for (size_t i = 0; i < count; ++i) values[i] = list[i].number(low, high);
}

size_t GltfValue::reference(const char* key, const char* array, size_t available) const {
    const GltfValue value = (*this)[key];
    const uint64_t index = value.whole(uint64_t{1} << 53);
    if (index >= available)
        value.fail("is " + std::to_string(index) + "; there are " + std::to_string(available) + " " + array);
    return size_t(index);
}

namespace {

// "glTF", "JSON", "BIN"
constexpr uint32_t magic = 0x46546C67, jsonChunk = 0x4E4F534A, binaryChunk = 0x004E4942;
constexpr uint64_t jsonLimit = uint64_t{64} << 20;  // as a tree it takes some thirty times as much
constexpr uint64_t mostBytes = uint64_t{1} << 53;   // JSON's numbers are whole up to there

uint32_t wordAt(const std::string& bytes, size_t at) {  // little endian
    uint32_t word = 0;
    for (size_t i = 4; i-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
    return word;
}

// Chunks of a .glb; anything else is JSON alone.
std::pair<std::string, std::string> chunksOf(const std::string& path, const std::string& bytes) {
    if (bytes.size() < 4 || wordAt(bytes, 0) != magic) return {bytes, ""};
    if (bytes.size() < 20) throw FileError(path, "ends within the header of a .glb");
    const uint32_t version = wordAt(bytes, 4), total = wordAt(bytes, 8);
    if (version != 2)
        throw FileError(path,
                        "is a .glb of version " + std::to_string(version) + "; version 2 would be right");
    if (total > bytes.size())
        throw FileError(
            path, "has " + std::to_string(bytes.size()) + " bytes; its header says " + std::to_string(total));
    std::string json, binary;
    bool hasBinary = false;
    for (size_t at = 12, chunk = 0; at + 8 <= total; ++chunk) {
        const uint64_t length = wordAt(bytes, at), end = at + 8 + length;
        const uint32_t kind = wordAt(bytes, at + 4);
        if (end > total)
            throw FileError(path, "has a chunk of " + std::to_string(length) + " bytes that leaves the file");
        if ((kind == jsonChunk) != (chunk == 0))
            throw FileError(path, "has no JSON in its first chunk alone");
        if (kind == jsonChunk) json = bytes.substr(at + 8, length);
        if (kind == binaryChunk && !hasBinary) binary = bytes.substr(at + 8, length), hasBinary = true;
        at = size_t(end);
    }
    return {json, binary};
}

std::string fromBase64(const GltfValue& value, const std::string& text, size_t at) {
    constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<int8_t, 256> digit;
    digit.fill(-1);
    for (int i = 0; i < 64; ++i) digit[static_cast<unsigned char>(letters[i])] = int8_t(i);
    std::string out;
    out.reserve((text.size() - at) / 4 * 3);
    uint32_t bits = 0;
    int count = 0;
    for (; at < text.size() && text[at] != '='; ++at) {
        const int d = digit[static_cast<unsigned char>(text[at])];
        if (d < 0) value.fail("holds a letter that is not of base64");
        bits = bits << 6 | uint32_t(d);
        if (++count % 4 != 1) out += char(bits >> (6 - 2 * ((count - 1) % 4)) & 255);
    }
    return out;
}

// A path below the scene's folder. An untrusted file must not make the program read other files.
std::string relativePath(const GltfValue& value, const std::string& uri) {
    std::string path;
    for (size_t i = 0; i < uri.size(); ++i) {
        const char* digits = uri.c_str() + i + 1;
        unsigned code = 0;
        const bool escaped = uri[i] == '%' && i + 2 < uri.size() &&
                             std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2;
        path += escaped ? char(code) : uri[i];
        if (escaped) i += 2;
    }
    bool outside = path.empty() || path[0] == '/' || path.find('\\') != std::string::npos ||
                   path.find(':') != std::string::npos || path.find('\0') != std::string::npos;
    for (size_t at = 0; at <= path.size() && !outside;) {
        const size_t end = std::min(path.find('/', at), path.size());
        const std::string part = path.substr(at, end - at);
        outside = part.empty() || part == ".." || part == ".";
        at = end + 1;
    }
    if (outside)
        value.fail("is '" + uri.substr(0, 80) +
                   "'; a file beside the scene or below, or a data: URI would be right");
    return path;
}

// Required extensions that can be ignored: without them the geometry is still correct.
bool isKnown(const std::string& extension) {
    if (extension.starts_with("KHR_materials_") || extension.starts_with("KHR_lights_")) return true;
    for (const char* known : {"KHR_texture_transform", "KHR_mesh_quantization", "KHR_xmp_json_ld",
                              "EXT_texture_webp", "KHR_texture_basisu", "KHR_animation_pointer"})
        if (extension == known) return true;
    return false;
}

template <class T>
double stored(const char* at, double largest) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return std::max(double(value) / largest, std::is_signed_v<T> && largest > 1 ? -1.0 : -INFINITY);
}

// How components are stored [glTF 2.0, 3.6.2.2], by componentType.
constexpr struct {
    uint64_t type, bytes;
    double largest;  // 1 as a fraction
    double (*read)(const char* at, double largest);
} componentTypes[] = {{5120, 1, 127, stored<int8_t>},    {5121, 1, 255, stored<uint8_t>},
                      {5122, 2, 32767, stored<int16_t>}, {5123, 2, 65535, stored<uint16_t>},
                      {5125, 4, 1, stored<uint32_t>},    {5126, 4, 1, stored<float>}};

uint64_t bytesOf(const GltfValue& accessor, uint64_t type) {
    for (const auto& known : componentTypes)
        if (known.type == type) return known.bytes;
    accessor["componentType"].fail("is " + std::to_string(type) + "; 5120 to 5123, 5125 and 5126 are known");
}

double component(const char* at, uint64_t type, bool normalized) {
    const auto& known = componentTypes[type - 5120 - (type > 5123)];
    return known.read(at, normalized ? known.largest : 1);
}

}  // namespace

struct GltfDocument::Layout {
    uint64_t count = 0, type = 0, components = 0, componentBytes = 0;
    bool normalized = false;
    uint64_t bytes() const { return components * componentBytes; }
};

GltfDocument::GltfDocument(const std::string& path, const std::string& bytes, const GltfResource& resource)
    : path_(path), resource_(resource) {
    auto [text, binary] = chunksOf(path, bytes);
    binary_ = std::move(binary);
    if (text.size() > jsonLimit)
        throw FileError(path, "has " + tooLarge(double(text.size()), jsonLimit) + " of JSON");
    json_ = std::make_shared<const nlohmann::json>(nlohmann::json::parse(text, nullptr, false));
    if (!json_->is_object()) throw FileError(path, "is neither a .glb nor JSON");
    const GltfValue top = root();
    const std::string version = top["asset"].text("version", "");
    if (!version.starts_with("2."))
        top["asset"].fail("says version '" + version.substr(0, 20) + "'; glTF 2 would be right");
    for (size_t i = 0; i < top.count("extensionsRequired"); ++i) {
        const GltfValue name = top["extensionsRequired"][i];
        if (!isKnown(name.text()))
            name.fail("is " + name.text().substr(0, 80) +
                      ", which is not supported: write the scene without it (uncompressed)");
    }
    uint64_t total = 0;
    for (size_t i = 0; i < top.count("buffers"); ++i) {
        const GltfValue buffer = top["buffers"][i];
        const uint64_t length = buffer["byteLength"].whole(mostBytes);
        std::string data;
        if (buffer.has("uri"))
            data = this->resource(buffer["uri"]);
        else if (i == 0)
            data = std::move(binary_);
        else
            buffer.fail("has no 'uri', and is not the first of a .glb");
        if (data.size() < length)
            buffer.fail("has " + std::to_string(data.size()) + " bytes, and says " + std::to_string(length));
        total += data.size();
        if (total > inputLimit()) buffer.fail("is too large: " + tooLarge(double(total), inputLimit()));
        data.resize(size_t(length));
        buffers_.push_back(std::move(data));
    }
}

std::string GltfDocument::resource(const GltfValue& value) const {
    const std::string& uri = value.text();
    if (!uri.starts_with("data:")) {
        const std::string name = relativePath(value, uri);
        try {
            return resource_(name);
        } catch (const FileError& e) {
            value.fail(std::string("leads to nothing: ") + e.what());
        }
    }
    const size_t comma = uri.find(',');
    if (comma == std::string::npos || comma < 12 || uri.compare(comma - 7, 7, ";base64") != 0)
        value.fail("is a data: URI without ';base64,'");
    return fromBase64(value, uri, comma + 1);
}

void GltfDocument::spend(const GltfValue& value, double bytes) const {
    decodedBytes_ += bytes;
    if (decodedBytes_ > double(inputLimit()))
        value.fail("makes the scene too large: " + tooLarge(decodedBytes_, inputLimit()));
}

GltfDocument::Span GltfDocument::view(const GltfValue& owner, const char* key) const {
    const GltfValue view = root().element("bufferViews", owner, key);
    const std::string& buffer = buffers_[view.reference("buffer", "buffers", buffers_.size())];
    const uint64_t offset = view.whole("byteOffset", 0, mostBytes),
                   length = view["byteLength"].whole(mostBytes);
    if (offset > buffer.size() || length > buffer.size() - offset)
        view.fail("ends at byte " + std::to_string(offset + length) + " of a buffer of " +
                  std::to_string(buffer.size()));
    return {buffer.data() + offset, length, view.whole("byteStride", 0, 252)};
}

GltfDocument::Layout GltfDocument::layout(const GltfValue& accessor) const {
    Layout l;
    l.count = accessor["count"].whole(mostBytes);
    l.type = accessor["componentType"].whole(mostBytes);
    l.componentBytes = bytesOf(accessor, l.type);
    const std::string& type = accessor["type"].text();
    l.components = type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
    if (!l.components)
        accessor["type"].fail("is '" + type.substr(0, 20) + "'; SCALAR, VEC2, VEC3 or VEC4 would be right");
    l.normalized = accessor.flag("normalized");
    spend(accessor["count"], 4.0 * double(l.count) * double(l.components));
    return l;
}

// Calls store(index, bytes) for each element of `owner`, an object with bufferView and byteOffset.
template <class Store>
void GltfDocument::read(const GltfValue& owner, const Layout& l, Store&& store) const {
    const Span span = view(owner, "bufferView");
    const uint64_t offset = owner.whole("byteOffset", 0, mostBytes), element = l.bytes(),
                   stride = span.stride ? span.stride : element;
    if (l.count == 0) return;
    if (stride < element)
        owner.fail("has elements of " + std::to_string(element) + " bytes " + std::to_string(stride) +
                   " bytes apart");
    // No overflow: the count is below inputLimit() and the stride below 256.
    const uint64_t end = offset + (l.count - 1) * stride + element;
    if (end > span.size)
        owner.fail("ends at byte " + std::to_string(end) + " of a view of " + std::to_string(span.size));
    for (uint64_t i = 0; i < l.count; ++i) store(i, span.data + offset + i * stride);
}

// All elements of an accessor, and those that replace some of them if it is sparse.
template <class Store>
void GltfDocument::readAll(const GltfValue& accessor, const Layout& l, Store&& store) const {
    if (accessor.has("bufferView")) read(accessor, l, store);
    if (!accessor.has("sparse")) return;
    const GltfValue sparse = accessor["sparse"], where = sparse["indices"];
    Layout index{sparse["count"].whole(l.count), where["componentType"].whole(mostBytes), 1, 0, false};
    index.componentBytes = bytesOf(where, index.type);
    std::vector<uint64_t> at(index.count);
    read(where, index, [&](uint64_t i, const char* bytes) {
        const double value = component(bytes, index.type, false);
        if (!(value >= 0 && value < double(l.count)))
            where.fail("holds " + std::to_string(int64_t(std::min(value, 9e15))) + " of " +
                       std::to_string(l.count) + " elements");
        at[i] = uint64_t(value);
    });
    Layout values = l;
    values.count = index.count;
    read(sparse["values"], values, [&](uint64_t i, const char* bytes) { store(at[i], bytes); });
}

std::vector<float> GltfDocument::floats(const GltfValue& owner, const char* key, size_t components) const {
    const GltfValue accessor = root().element("accessors", owner, key);
    const Layout l = layout(accessor);
    if (l.components != components)
        accessor["type"].fail("has " + std::to_string(l.components) + " numbers each; " + owner.where() +
                              "." + key + " needs " + std::to_string(components));
    std::vector<float> values(l.count * components);
    readAll(accessor, l, [&](uint64_t i, const char* bytes) {
        for (size_t c = 0; c < components; ++c)
            values[i * components + c] = float(component(bytes + c * l.componentBytes, l.type, l.normalized));
    });
    return values;
}

std::vector<uint32_t> GltfDocument::indices(const GltfValue& owner, const char* key) const {
    const GltfValue accessor = root().element("accessors", owner, key);
    const Layout l = layout(accessor);
    if (l.components != 1 || l.type == 5126 || l.type == 5120 || l.type == 5122)
        accessor.fail("holds no indices: unsigned SCALARs would be right");
    std::vector<uint32_t> values(l.count);
    readAll(accessor, l,
            [&](uint64_t i, const char* bytes) { values[i] = uint32_t(component(bytes, l.type, false)); });
    return values;
}

GltfImage GltfDocument::image(size_t index) const {
    const GltfValue image = root()["images"][index];
    GltfImage found;
    if (image.has("uri")) {
        found.bytes = resource(image["uri"]);
    } else {
        const Span span = view(image, "bufferView");
        found.bytes.assign(span.data, span.size);
    }
    spend(image, double(found.bytes.size()));
    // The signature decides, because the MIME type in files is often wrong.
    const bool png = found.bytes.starts_with("\x89PNG\r\n"), jpeg = found.bytes.starts_with("\xff\xd8\xff");
    found.name = path_ + ": " + image.where() + (png ? ".png" : jpeg ? ".jpg" : "");
    if (!png && !jpeg) found.bytes.clear();
    return found;
}

}  // namespace pellucid::io
