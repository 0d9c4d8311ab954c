#include "gltf/gltf_value.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

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

}  // namespace pellucid::io
