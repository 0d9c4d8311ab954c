#include "gltf/gltf_document.h"

#include <charconv>
#include <nlohmann/json.hpp>

namespace pellucid::io {

void GltfValue::fail(const std::string& message) const {
    throw FileError(*file_, (where_.empty() ? "the scene" : where_) + " " + message);
}

bool GltfValue::has(const char* key) const {
    return json_->is_object() && json_->contains(key);
}

GltfValue GltfValue::operator[](const char* key) const {
    if (!json_->is_object()) fail("is not an object");
    const auto at = json_->find(key);
    if (at == json_->end()) fail(std::string("has no '") + key + "'");
    return GltfValue(*file_, *at, where_.empty() ? key : where_ + "." + key);
}

GltfValue GltfValue::operator[](size_t index) const {
    return GltfValue(*file_, (*json_)[index], concat(where_, "[", index, "]"));
}

size_t GltfValue::size() const {
    if (!json_->is_array()) fail("is not an array");
    return json_->size();
}

double GltfValue::anyNumber() const {
    if (!json_->is_number()) fail("is not a number");
    return json_->get<double>();
}

double GltfValue::number(double low, double high) const {
    const double value = anyNumber();
    if (value >= low && value <= high) return value;
    fail(concat("is ", value, "; ", low, " to ", high, " is possible"));
}

uint64_t GltfValue::whole(uint64_t most) const {
    const double value = anyNumber();  // some programs write whole numbers with a point
    if (!(value >= 0 && value <= double(most)) || value != std::floor(value))
        fail(concat("is ", json_->dump(), "; a whole number from 0 to ", most, " would be right"));
    return uint64_t(value);
}

const std::string& GltfValue::text() const {
    if (!json_->is_string()) fail("is not a string");
    return json_->get_ref<const std::string&>();
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
    if (list.size() != count) list.fail(concat("has ", list.size(), " values; ", count, " would be right"));
    for (size_t i = 0; i < count; ++i) values[i] = list[i].number(low, high);
}

size_t GltfValue::index(const char* array, size_t available) const {
    const uint64_t index = whole(uint64_t{1} << 53);
    if (index >= available) fail(concat("is ", index, "; there are ", available, " ", array));
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
        throw FileError(path, concat("is a .glb of version ", version, "; version 2 would be right"));
    if (total > bytes.size())
        throw FileError(path, concat("has ", bytes.size(), " bytes; its header says ", total));
    std::string json, binary;
    bool hasBinary = false;
    for (size_t at = 12, chunk = 0; at + 8 <= total; ++chunk) {
        const uint64_t length = wordAt(bytes, at), end = at + 8 + length;
        const uint32_t kind = wordAt(bytes, at + 4);
        if (end > total)
            throw FileError(path, concat("has a chunk of ", length, " bytes that ends after the file"));
        if ((kind == jsonChunk) != (chunk == 0))
            throw FileError(path, "must have JSON in its first chunk, and only there");
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
        if (d < 0) value.fail("holds a character that is not base64");
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
    std::string below;  // without parts "."
    for (size_t at = 0; at <= path.size() && !outside;) {
        const size_t end = std::min(path.find('/', at), path.size());
        const std::string part = path.substr(at, end - at);
        outside = part.empty() || part == "..";
        if (part != ".") below.append(below.empty() ? "" : "/").append(part);
        at = end + 1;
    }
    if (outside || below.empty())
        value.fail("is '" + uri.substr(0, 80) +
                   "'; a file beside the scene or below, or a data: URI would be right");
    return below;
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
double stored(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return double(value);
}

}  // namespace

// How components are stored [glTF 2.0, 3.6.2.2].
struct GltfDocument::Component {
    uint64_t type, bytes;
    double lowest, largest;  // of a normalised one: as a fraction, and 1 as a whole number
    double (*read)(const char* at);

    static const Component& of(const GltfValue& owner) {
        static constexpr Component all[] = {
            {5120, 1, -1, 127, stored<int8_t>},    {5121, 1, 0, 255, stored<uint8_t>},
            {5122, 2, -1, 32767, stored<int16_t>}, {5123, 2, 0, 65535, stored<uint16_t>},
            {5125, 4, 0, 1, stored<uint32_t>},     {5126, 4, -INFINITY, 1, stored<float>}};
        const GltfValue type = owner["componentType"];
        for (const Component& known : all)
            if (known.type == type.whole(mostBytes)) return known;
        type.fail(concat("is ", type.whole(mostBytes), "; 5120 to 5123, 5125 and 5126 are known"));
    }
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
            buffer.fail(concat("has ", data.size(), " bytes, but its byteLength is ", length));
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
            value.fail(std::string("cannot be loaded: ") + e.what());
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
        view.fail(concat("ends at byte ", offset + length, " of a buffer of ", buffer.size()));
    return {buffer.data() + offset, length, view.whole("byteStride", 0, 252)};
}

// `count` elements of `owner`, an object with bufferView and byteOffset.
std::vector<double> GltfDocument::elements(const GltfValue& owner, uint64_t count, const Component& kind,
                                           uint64_t components) const {
    const Span span = view(owner, "bufferView");
    const uint64_t offset = owner.whole("byteOffset", 0, mostBytes), element = components * kind.bytes,
                   stride = span.stride ? span.stride : element;
    std::vector<double> values;
    if (count == 0) return values;
    if (stride < element) owner.fail(concat("has elements of ", element, " bytes ", stride, " bytes apart"));
    // No overflow: the count is below inputLimit() and the stride below 256.
    const uint64_t end = offset + (count - 1) * stride + element;
    if (end > span.size) owner.fail(concat("ends at byte ", end, " of a view of ", span.size));
    for (uint64_t i = 0; i < count; ++i)
        for (uint64_t c = 0; c < components; ++c)
            values.push_back(kind.read(span.data + offset + i * stride + c * kind.bytes));
    return values;
}

// All elements of an accessor, with those that replace some of them if it is sparse.
std::vector<double> GltfDocument::numbers(const GltfValue& owner, const char* key, size_t components) const {
    constexpr const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const char* wanted = components == 16 ? "MAT4" : types[components - 1];
    const GltfValue accessor = root().element("accessors", owner, key);
    const Component& kind = Component::of(accessor);
    const uint64_t count = accessor["count"].whole(mostBytes);
    if (accessor["type"].text() != wanted)
        accessor["type"].fail("is '" + accessor["type"].text().substr(0, 20) + "'; " + owner.where() + "." +
                              key + " needs " + wanted);
    spend(accessor["count"], 8.0 * double(count) * double(components));
    std::vector<double> values = accessor.has("bufferView") ? elements(accessor, count, kind, components)
                                                            : std::vector<double>(count * components);
    if (accessor.has("sparse")) {
        const GltfValue sparse = accessor["sparse"], where = sparse["indices"];
        const uint64_t replaced = sparse["count"].whole(count);
        const std::vector<double> at = elements(where, replaced, Component::of(where), 1),
                                  with = elements(sparse["values"], replaced, kind, components);
        for (size_t i = 0; i < replaced; ++i) {
            if (!(at[i] >= 0 && at[i] < double(count)))
                where.fail(concat("holds ", int64_t(std::min(at[i], 9e15)), " of ", count, " elements"));
            std::copy_n(&with[i * components], components, &values[size_t(at[i]) * components]);
        }
    }
    if (accessor.flag("normalized"))
        for (double& value : values) value = std::max(value / kind.largest, kind.lowest);
    return values;
}

std::vector<float> GltfDocument::floats(const GltfValue& owner, const char* key, size_t components) const {
    const std::vector<double> values = numbers(owner, key, components);
    return {values.begin(), values.end()};
}

std::vector<uint32_t> GltfDocument::indices(const GltfValue& owner, const char* key) const {
    const GltfValue accessor = root().element("accessors", owner, key);
    if (const uint64_t type = Component::of(accessor).type; type == 5126 || type == 5120 || type == 5122)
        accessor.fail("holds no indices: unsigned SCALARs would be right");
    const std::vector<double> values = numbers(owner, key, 1);
    return {values.begin(), values.end()};
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
