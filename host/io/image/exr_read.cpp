// Reads OpenEXR files. Bands of rows are decoded in parallel, each by its own reader over the same bytes: a
// thread pool would be missing in a forked process.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfCompressionAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFloatVectorAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTileDescriptionAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <atomic>
#include <cstring>

#include "io/image/exr_file.h"
#include "io/image/image_format.h"
#include "system/threads.h"

namespace pellucid::io {
namespace {

class MemoryStream final : public Imf::IStream {
  public:
    MemoryStream(const std::string& path, const std::string& bytes) : IStream(path.c_str()), bytes_(bytes) {}
    bool read(char to[], int count) override {
        need(count);
        std::memcpy(to, bytes_.data() + at_, size_t(count));
        at_ += uint64_t(count);
        return at_ < bytes_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t at) override { at_ = at; }

  private:
    void need(int count) const {
        if (count < 0 || at_ > bytes_.size() || bytes_.size() - at_ < uint64_t(count))
            throw Iex::InputExc("it ends too early");
    }
    const std::string& bytes_;
    uint64_t at_ = 0;
};

// How a part is read.
struct PartPlan {
    Imath::Box2i data;
    int rows = 1;  // of a band: whole chunks, or whole tiles
    size_t first = 0;
    std::vector<std::string> names;  // of its channels, in the order of the image
};

// Sorts by layer, then R, G, B, A in this order, then by name.
void sortChannels(std::vector<std::string>& names) {
    const auto key = [](const std::string& name) {
        const size_t dot = name.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : name.substr(0, dot);
        const std::string own = dot == std::string::npos ? name : name.substr(dot + 1);
        const size_t color = own.size() == 1 ? std::string_view("RGBA").find(own[0]) : std::string_view::npos;
        return std::tuple(layer, color, own);
    };
    std::ranges::sort(names, {}, key);
}

template <class T>
void copyAs(Image& image, const char* name, const Imf::Attribute& attribute) {
    const auto* typed = dynamic_cast<const Imf::TypedAttribute<T>*>(&attribute);
    if (!typed) return;
    if constexpr (std::is_constructible_v<Attribute, T>) {
        image.attributes.emplace_back(name, typed->value());
    } else {  // vectors and matrices as their floats
        const auto* first = reinterpret_cast<const float*>(&typed->value());
        image.attributes.emplace_back(name, std::vector<float>(first, first + sizeof(T) / sizeof *first));
    }
}

template <class... T>
void copyAttributes(Image& image, const Imf::Header& header) {
    for (auto i = header.begin(); i != header.end(); ++i) (copyAs<T>(image, i.name(), i.attribute()), ...);
}

PartPlan planPart(Image& image, const Imf::Header& header, int part, bool severalParts, uint64_t limit) {
    const Imath::Box2i& display = header.displayWindow();
    const int width = display.max.x - display.min.x + 1, height = display.max.y - display.min.y + 1;
    if (part == 0) image.width = width, image.height = height;
    if (width != image.width || height != image.height)
        throw FileError(image.source,
                        concat("part ", part, " is ", width, " x ", height, " pixels, part 0 is ",
                               image.width, " x ", image.height, "; all parts must have one display window"));
    PartPlan plan;
    plan.data = header.dataWindow();
    plan.first = image.channels.size();
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        plan.names.emplace_back(c.name());
    sortChannels(plan.names);
    checkImageSize(image.source, plan.data.max.x - plan.data.min.x + 1, plan.data.max.y - plan.data.min.y + 1,
                   double(plan.names.size()), limit);
    // Channels of multi-part files are prefixed with the name of their part, unless they have that prefix.
    const std::string prefix =
        severalParts && header.hasName() && !header.name().empty() ? header.name() + "." : "";
    for (const std::string& name : plan.names) {
        const bool half = header.channels()[name].type == Imf::HALF;
        image.channels.push_back({name.starts_with(prefix) ? name : prefix + name,
                                  half ? ChannelType::Half : ChannelType::Float,
                                  {}});
    }
    constexpr int wholeChunks = 32, wholeChunksOfDwab = 256;
    plan.rows = header.compression() == Imf::DWAB_COMPRESSION ? wholeChunksOfDwab : wholeChunks;
    if (header.hasTileDescription()) plan.rows = int(std::min(header.tileDescription().ySize, 1u << 20));
    return plan;
}

// Whether a stored row has the width and position of a row of the picture.
bool isDirect(const Imath::Box2i& data, const Imath::Box2i& display) {
    return data.min.x == display.min.x && data.max.x == display.max.x && data.min.y >= display.min.y &&
           data.max.y <= display.max.y;
}

// Reads the rows [begin, end) of a part to `places`, one per channel of the image.
void readLines(const ExrLines& lines, int part, const PartPlan& plan, const std::vector<Place>& places,
               int top, int begin, int end) {
    const auto width = size_t(plan.data.max.x - plan.data.min.x + 1);
    std::vector<ExrLines::Target> targets;
    for (size_t c = 0; c < plan.names.size(); ++c) {
        const Place& place = places[plan.first + c];
        if (place.first)
            targets.push_back({plan.names[c], place.first + size_t(begin - top) * width * place.stride,
                               place.stride, width * place.stride});
    }
    if (!targets.empty()) lines.read(part, begin, end, width, targets);
}

// Like readLines, for every kind of part.
void readBand(const Image& image, Imf::MultiPartInputFile& file, int part, const PartPlan& plan,
              const std::vector<Place>& places, int begin, int end) {
    const Imath::Box2i &data = plan.data, display = file.header(part).displayWindow();
    const size_t width = size_t(data.max.x - data.min.x + 1);
    const bool direct = isDirect(data, display);
    std::vector<std::vector<float>> bands;
    std::vector<Place> wanted;
    Imf::FrameBuffer frame;
    for (size_t c = 0; c < plan.names.size(); ++c) {
        const Place& place = places[plan.first + c];
        if (!place.first) continue;
        wanted.push_back(place);
        if (!direct) bands.emplace_back(width * size_t(end - begin));
        const size_t stride = direct ? place.stride : 1;
        float* firstPixel =
            direct ? place.first + size_t(begin - display.min.y) * width * stride : bands.back().data();
        // OpenEXR takes the address of pixel (0, 0) in its coordinates, which may be outside of the buffer.
        const int64_t origin =
            (int64_t(begin) * int64_t(width) + data.min.x) * int64_t(stride * sizeof(float));
        char* base = reinterpret_cast<char*>(reinterpret_cast<uintptr_t>(firstPixel) - uintptr_t(origin));
        frame.insert(plan.names[c],
                     Imf::Slice(Imf::FLOAT, base, stride * sizeof(float), width * stride * sizeof(float)));
    }
    if (wanted.empty()) return;
    Imf::InputPart input(file, part);
    input.setFrameBuffer(frame);
    input.readPixels(begin, end - 1);
    if (direct) return;
    const int left = std::max(data.min.x, display.min.x), right = std::min(data.max.x, display.max.x);
    if (left > right) return;
    for (int y = std::max(begin, display.min.y); y < std::min(end, display.max.y + 1); ++y)
        for (size_t c = 0; c < wanted.size(); ++c) {
            const float* from = bands[c].data() + size_t(y - begin) * width + size_t(left - data.min.x);
            const size_t first =
                size_t(y - display.min.y) * size_t(image.width) + size_t(left - display.min.x);
            for (size_t x = 0; x <= size_t(right - left); ++x)
                wanted[c].first[(first + x) * wanted[c].stride] = from[x];
        }
}

// Null if the C library refuses the file; the C++ library then decides.
std::unique_ptr<const ExrLines> linesOf(const std::string& path, const std::string& bytes) {
    try {
        return std::make_unique<const ExrLines>(path, bytes);
    } catch (const FileError&) {
        return nullptr;
    }
}

struct Band {
    int part, begin, end;
};

// Runs worker(next) on every processor; next() hands out numbers below `count`. Throws what a worker throws.
template <class Worker>
void onProcessors(size_t count, const Worker& worker) {
    std::atomic<size_t> next{0};
    pel::inParts(count, pel::partsOf(count, 1), [&](size_t, size_t, size_t) {
        try {
            worker([&]() -> std::optional<size_t> {
                const size_t i = next++;
                return i < count ? std::optional(i) : std::nullopt;
            });
        } catch (...) {
            next = count;  // the others need not go on
            throw;
        }
    });
}

}  // namespace

std::vector<Place> ownPlaces(Image& image, const std::vector<std::string>* names) {
    std::vector<bool> wanted(image.channels.size(), !names);
    if (names)
        for (const std::string& name : *names)
            if (image.has(name)) wanted[size_t(&image.channel(name) - image.channels.data())] = true;
    std::vector<Place> places(image.channels.size());
    onProcessors(wanted.size(), [&](auto&& next) {
        while (const auto c = next())
            if (wanted[*c]) {
                image.channels[*c].pixels.resize(image.pixelCount());
                places[*c].first = image.channels[*c].pixels.data();
            }
    });
    return places;
}

void decodeExr(Image& image, const std::string& bytes, const std::function<void(const Image&)>& check,
               uint64_t limit, const PlaceChannels& placesOf) try {
    MemoryStream stream(image.source, bytes);
    Imf::MultiPartInputFile file(stream, 0);
    copyAttributes<std::string, int, float, Imath::V2f, Imath::V3f, Imath::M33f, Imath::M44f,
                   std::vector<float>>(image, file.header(0));
    std::vector<PartPlan> parts;
    for (int part = 0; part < file.parts(); ++part)
        parts.push_back(planPart(image, file.header(part), part, file.parts() > 1, limit));
    checkImageSize(image.source, image.width, image.height, double(image.channels.size()), limit);
    if (check) check(image);
    const std::vector<Place> places = placesOf(image);
    const std::unique_ptr<const ExrLines> lines = linesOf(image.source, bytes);
    std::vector<Band> bands;
    std::vector<bool> inLines;
    for (size_t part = 0; part < parts.size(); ++part) {
        const PartPlan& plan = parts[part];
        const Imf::Header& header = file.header(int(part));
        inLines.push_back(lines && isDirect(plan.data, header.displayWindow()) &&
                          !header.hasTileDescription() && header.compression() <= Imf::ZIP_COMPRESSION);
        for (int64_t y = plan.data.min.y; y <= plan.data.max.y; y += plan.rows)
            bands.push_back(
                {int(part), int(y), int(std::min<int64_t>(y + plan.rows, int64_t(plan.data.max.y) + 1))});
    }
    onProcessors(bands.size(), [&](auto&& next) {
        MemoryStream own(image.source, bytes);
        std::optional<Imf::MultiPartInputFile> reader;
        while (const auto i = next()) {
            const Band& band = bands[*i];
            const PartPlan& plan = parts[size_t(band.part)];
            if (inLines[size_t(band.part)]) {
                readLines(*lines, band.part, plan, places, file.header(band.part).displayWindow().min.y,
                          band.begin, band.end);
                continue;
            }
            if (!reader) reader.emplace(own, 0);
            readBand(image, *reader, band.part, plan, places, band.begin, band.end);
        }
    });
} catch (const Iex::BaseExc& e) {
    throw FileError(image.source, std::string("is damaged or cut off: ") + e.what());
} catch (const std::length_error&) {  // of a container inside OpenEXR
    throw FileError(image.source, "is damaged: it gives a number of elements that is impossible");
}

}  // namespace pellucid::io
