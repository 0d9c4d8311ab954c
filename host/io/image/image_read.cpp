// Reading of images: what imageFormat() accepted is decoded from memory.
#include "io/file_error.h"
#include "io/image/exr_file.h"
#include "io/image/image_file.h"
#include "io/image/picture_library.h"
#include "io/input_file.h"

namespace pellucid::io {

Image decodeImage(const std::string& path, std::string bytes, const std::function<void(const Image&)>& check,
                  uint64_t limit, const std::vector<std::string>* names) {
    const ImageFormat format = imageFormat(path, std::move(bytes), limit);
    Image image;
    image.source = path;
    if (format.reader == std::string_view("openexr"))
        decodeExr(image, format.bytes, check, limit, names);
    else
        pictureLibrary(path).decode(image, format, check, limit);
    return image;
}

Image readImage(const std::string& path, const std::function<void(const Image&)>& check, uint64_t limit) {
    return decodeImage(path, readWholeFile(path, limit), check, limit);
}

Image readChannels(const std::string& path, const std::vector<std::string>& names) {
    return decodeImage(path, readWholeFile(path), {}, inputLimit(), &names);
}

}  // namespace pellucid::io
