// Decodes images in memory after imageFormat() has checked them.
#include "io/image/exr_file.h"
#include "io/image/picture_library.h"

namespace pellucid::io {

Image decodeImage(const std::string& path, std::string bytes, const std::function<void(const Image&)>& check,
                  uint64_t limit, const std::vector<std::string>* names) {
    const ImageFormat format = imageFormat(path, std::move(bytes), limit);
    Image image;
    image.source = path;
    if (format.reader == std::string_view("openexr"))
        decodeExr(image, format.bytes, check, limit, [&](Image& all) { return ownPlaces(all, names); });
    else
        pictureLibraryFor(format.reader, path).decode(image, format, check, limit);
    return image;
}

Image readImage(const std::string& path) {
    return decodeImage(path, readWholeFile(path));
}

Image readChannels(const std::string& path, const std::vector<std::string>& names) {
    return decodeImage(path, readWholeFile(path), {}, inputLimit(), &names);
}

Image readChannelsTo(const std::string& path, const PlaceChannels& places) {
    const ImageFormat format = imageFormat(path, readWholeFile(path), inputLimit());
    Image image;
    image.source = path;
    if (format.reader == std::string_view("openexr")) {
        decodeExr(image, format.bytes, {}, inputLimit(), places);
        return image;
    }
    pictureLibraryFor(format.reader, path).decode(image, format, {}, inputLimit());
    std::vector<std::vector<float>> pixels;
    for (Channel& c : image.channels) pixels.push_back(std::exchange(c.pixels, {}));
    const std::vector<Place> to = places(image);
    for (size_t c = 0; c < to.size(); ++c)
        if (to[c].first)
            for (size_t i = 0; i < pixels[c].size(); ++i) to[c].first[i * to[c].stride] = pixels[c][i];
    return image;
}

}  // namespace pellucid::io
