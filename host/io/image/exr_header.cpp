#include "io/image/image_format.h"

#include <algorithm>
#include <cstring>

#include "io/input_file.h"

namespace pellucid::io {
namespace {

constexpr uint32_t deepFlag = 0x800, multiPartFlag = 0x1000;
constexpr size_t placeOfChunk = 8;     // bytes per chunk in the table before the pixels
constexpr size_t mostChannels = 1024;  // OpenImageIO's own limit

template <class T>
T numberAt(std::string_view bytes, size_t at) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

struct Window {
    int64_t width = 0, height = 0;
    double pixels() const { return double(width) * double(height); }
};

struct Part {
    size_t channels = 0;
    Window data, display;
    std::optional<Window> tile;
    int64_t rowsPerChunk = 1;
};

class Check {
  public:
    Check(const std::string& path, std::string_view file, uint64_t limit)
        : path_(path), file_(file), limit_(double(limit)) {}

    void run() {
        if (file_.size() < ExrAttributes::start) damaged("it ends in its header");
        const auto flags = numberAt<uint32_t>(file_, 4);
        if ((flags & 0xff) != 2) damaged(concat("it is of version ", flags & 0xff, ", not 2"));
        if (flags & deepFlag) throw FileError(path_, "holds deep pixels; flatten it first");
        size_t at = ExrAttributes::start;
        do {
            ExrAttributes header(file_, at);
            const Part part = readPart(header);
            if (!header.atEnd()) damaged("it ends in its header");
            at = header.position() + 1;
            count(part);
        } while ((flags & multiPartFlag) && !(at < file_.size() && file_[at] == '\0'));
    }

  private:
    [[noreturn]] void damaged(const std::string& how) const {
        throw FileError(path_, "is damaged or cut off: " + how);
    }

    Part readPart(ExrAttributes& header) const {
        Part part;
        while (const auto a = header.next()) {
            const auto need = [&](std::string_view type, size_t size) {
                if (a->type != type || a->value.size() < size)
                    damaged("its attribute " + std::string(a->name) + " is not a " + std::string(type));
            };
            if (a->name == "channels") {
                need("chlist", 1);
                part.channels = channelsOf(a->value);
            } else if (a->name == "dataWindow") {
                need("box2i", 16);
                part.data = windowOf(a->value);
            } else if (a->name == "displayWindow") {
                need("box2i", 16);
                part.display = windowOf(a->value);
            } else if (a->name == "tiles") {
                need("tiledesc", 9);
                part.tile = Window{numberAt<uint32_t>(a->value, 0), numberAt<uint32_t>(a->value, 4)};
            } else if (a->name == "compression") {
                need("compression", 1);
                // None, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
                constexpr int rows[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
                const auto method = uint8_t(a->value[0]);
                if (method >= std::size(rows))
                    throw FileError(path_,
                                    concat("has compression ", method,
                                           ", which is not supported; None, RLE, ZIP, PIZ, PXR24, B44 and "
                                           "DWA are"));
                part.rowsPerChunk = rows[method];
            } else if (a->name == "chunkCount") {
                need("int", 4);
                const auto chunks = numberAt<int32_t>(a->value, 0);
                if (chunks < 1 || size_t(chunks) > file_.size() / placeOfChunk)
                    damaged(concat("its attribute chunkCount is ", chunks));
            } else if (a->name == "type" && a->value.starts_with("deep")) {
                throw FileError(path_, "holds deep pixels; flatten it first");
            }
        }
        if (part.channels == 0 || part.data.width == 0 || part.display.width == 0)
            damaged("a part of it has no channels or no windows");
        return part;
    }

    // Names, each with type and sampling, ended by an empty name.
    size_t channelsOf(std::string_view list) const {
        constexpr size_t facts = 16;  // bytes after a name
        for (size_t count = 0, at = 0; at < list.size(); ++count) {
            if (list[at] == '\0') return count;
            const size_t end = list.find('\0', at);
            if (end == std::string_view::npos || list.size() - end - 1 < facts) break;
            if (numberAt<uint32_t>(list, end + 1) > 2) break;
            if (numberAt<int32_t>(list, end + 9) != 1 || numberAt<int32_t>(list, end + 13) != 1)
                throw FileError(
                    path_,
                    "has the channel '" + std::string(list.substr(at, end - at)) +
                        "' in another resolution than the picture; write all channels for every pixel");
            if (count == mostChannels)
                throw FileError(path_, concat("has more than ", mostChannels, " channels in one part"));
            at = end + 1 + facts;
        }
        damaged("its list of channels");
    }

    Window windowOf(std::string_view box) const {
        int64_t corner[4];
        for (size_t i = 0; i < 4; ++i) corner[i] = numberAt<int32_t>(box, 4 * i);
        const Window w{corner[2] - corner[0] + 1, corner[3] - corner[1] + 1};
        constexpr int64_t most = int64_t{1} << 30;  // sums of coordinates stay within an int
        if (w.width < 1 || w.height < 1 ||
            std::any_of(corner, corner + 4, [](int64_t c) { return c < -most || c > most; }))
            damaged(concat("a window of ", w.width, " x ", w.height, " pixels"));
        return w;
    }

    void count(const Part& part) {
        double pixels = std::max(part.display.pixels(), part.data.pixels());
        double chunks = std::max(1.0, double(part.data.height) / double(part.rowsPerChunk));
        if (part.tile) {
            const Window& t = *part.tile;
            if (t.width < 1 || t.height < 1) damaged("its tiles are empty");
            pixels = std::max(pixels, t.pixels());
            chunks = std::max(1.0, double(part.data.width) / double(t.width)) *
                     std::max(1.0, double(part.data.height) / double(t.height));
        }
        taken_ += pixels * double(part.channels) * sizeof(float);
        if (taken_ > limit_)
            throw FileError(
                path_, concat(part.display.width, " x ", part.display.height, " pixels (", part.data.width,
                              " x ", part.data.height, " of them stored) of ", part.channels,
                              " channels take ", tooLarge(taken_, uint64_t(limit_))));
        if (chunks * double(placeOfChunk) > double(file_.size()))
            damaged(concat("it is too short for ", part.data.width, " x ", part.data.height, " pixels"));
    }

    const std::string& path_;
    std::string_view file_;
    double limit_, taken_ = 0;
};

}  // namespace

std::optional<ExrAttributes::Attribute> ExrAttributes::next() {
    const size_t before = at_;
    const auto name = text(), type = name && !name->empty() ? text() : std::nullopt;
    if (type && file_.size() - at_ >= 4) {
        const auto size = numberAt<uint32_t>(file_, at_);
        at_ += 4;
        if (file_.size() - at_ >= size) {
            const Attribute found{*name, *type, file_.substr(at_, size), at_};
            at_ += size;
            return found;
        }
    }
    at_ = before;
    return {};
}

std::optional<std::string_view> ExrAttributes::text() {
    const size_t end = file_.find('\0', at_);
    if (end == std::string_view::npos) return {};
    const std::string_view found = file_.substr(at_, end - at_);
    at_ = end + 1;
    return found;
}

void checkExrHeader(const std::string& path, std::string_view file, uint64_t limit) {
    Check(path, file, limit).run();
}

}  // namespace pellucid::io
