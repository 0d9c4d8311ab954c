#include "io/image/exr_file.h"

#include <Imath/half.h>
#include <OpenEXR/openexr.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <mutex>

namespace pellucid::io {
namespace {

template <class Stored>
void spread(const uint8_t* from, size_t count, float* to, size_t stride) {
    for (size_t i = 0; i < count; ++i) {
        Stored value;
        std::memcpy(&value, from + i * sizeof value, sizeof value);
        to[i * stride] = float(value);
    }
}

// Copies the wanted channels to their destinations as floats. A chunk has rows, and a row has channels.
exr_result_t unpack(exr_decode_pipeline_t* decode) {
    const auto* at = static_cast<const uint8_t*>(decode->unpacked_buffer);
    for (int32_t row = 0; row < decode->chunk.height; ++row)
        for (int16_t c = 0; c < decode->channel_count; ++c) {
            const exr_coding_channel_info_t& channel = decode->channels[c];
            const auto count = size_t(channel.width);
            const uint8_t* values = at;
            at += count * size_t(channel.bytes_per_element);
            if (!channel.decode_to_ptr) continue;
            auto* to =
                reinterpret_cast<float*>(channel.decode_to_ptr + row * ptrdiff_t(channel.user_line_stride));
            const size_t stride = size_t(channel.user_pixel_stride) / sizeof(float);
            if (channel.data_type == EXR_PIXEL_HALF)
                spread<Imath::half>(values, count, to, stride);
            else if (channel.data_type == EXR_PIXEL_UINT)
                spread<uint32_t>(values, count, to, stride);
            else if (stride == 1)
                std::memcpy(to, values, count * sizeof(float));
            else
                spread<float>(values, count, to, stride);
        }
    return EXR_ERR_SUCCESS;
}

// A negative count precedes as many bytes as they are; any other a byte that occurs once more than it says.
bool undoRle(const uint8_t* from, size_t bytes, std::vector<uint8_t>& to) {
    const uint8_t* const end = from + bytes;
    size_t at = 0;
    while (from < end) {
        const int count = int8_t(*from++);
        const size_t length = size_t(count < 0 ? -count : count + 1), taken = count < 0 ? length : 1;
        if (length > to.size() - at || taken > size_t(end - from)) return false;
        if (count < 0)
            std::copy_n(from, length, &to[at]);
        else
            std::fill_n(&to[at], length, *from);
        at += length, from += taken;
    }
    return at == to.size();
}

bool undoZip(const uint8_t* from, size_t bytes, std::vector<uint8_t>& to) {
    uLongf size = to.size();
    return uncompress(to.data(), &size, from, uLong(bytes)) == Z_OK && size == to.size();
}

// Replaces each byte by the sum of all up to it, less 128 for each but the first. Eight bytes at a time, in
// lanes of 16 bits; two 128s cancel.
void sumUp(std::vector<uint8_t>& bytes) {
    static_assert(std::endian::native == std::endian::little);
    constexpr uint64_t low = 0x00ff00ff00ff00ff, ones = 0x0001000100010001;
    uint64_t sum = 128;
    size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {
        uint64_t eight;
        std::memcpy(&eight, &bytes[i], 8);
        const uint64_t even = (eight & low) * ones, odd = (eight >> 8 & low) * ones;
        eight = ((even + (odd << 16) + (sum + 128) * ones) & low) | ((even + odd + sum * ones) & low) << 8;
        std::memcpy(&bytes[i], &eight, 8);
        sum = (sum + ((even + odd) >> 48)) & 255;
    }
    for (; i < bytes.size(); ++i) sum += bytes[i] + 128u, bytes[i] = uint8_t(sum);
}

// Undoes RLE or ZIP, which store the differences of a chunk's bytes plus 128, the even ones before the odd
// ones. OpenEXR 3.1 does the same, but each of its sums waits for the one before to reach memory: a fifth of
// the processor time of `pellucid shade`.
template <bool (*undo)(const uint8_t*, size_t, std::vector<uint8_t>&)>
exr_result_t decompress(exr_decode_pipeline_t* decode) {
    if (decode->unpacked_buffer == decode->packed_buffer) return EXR_ERR_SUCCESS;  // stored as it is
    auto& scratch = *static_cast<std::vector<uint8_t>*>(decode->decoding_user_data);
    const size_t size = decode->chunk.unpacked_size, even = (size + 1) / 2;
    scratch.resize(size);
    if (!undo(static_cast<const uint8_t*>(decode->packed_buffer), decode->chunk.packed_size, scratch))
        return EXR_ERR_CORRUPT_CHUNK;
    sumUp(scratch);
    const uint8_t *first = scratch.data(), *second = first + even;
    auto* to = static_cast<uint8_t*>(decode->unpacked_buffer);
    for (size_t i = 0; i < size / 2; ++i) to[2 * i] = first[i], to[2 * i + 1] = second[i];
    if (size % 2) to[size - 1] = first[even - 1];
    return EXR_ERR_SUCCESS;
}

}  // namespace

struct ExrLines::File {
    std::string path;
    const std::string& bytes;
    exr_context_t context = nullptr;
    mutable std::mutex mutex;
    mutable std::string error;  // the last

    void check(exr_result_t code) const {
        if (code == EXR_ERR_SUCCESS) return;
        const std::lock_guard lock(mutex);
        throw FileError(
            path, "is damaged or cut off: " + (error.empty() ? exr_get_default_error_message(code) : error));
    }
};

ExrLines::ExrLines(const std::string& path, const std::string& bytes)
    : file_(new File{path, bytes, nullptr, {}, {}}) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.user_data = file_.get();
    settings.read_fn = [](exr_const_context_t, void* user, void* to, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t) -> int64_t {
        const std::string& all = static_cast<const ExrLines::File*>(user)->bytes;
        if (offset >= all.size()) return 0;
        const uint64_t got = std::min<uint64_t>(size, all.size() - offset);
        std::memcpy(to, all.data() + offset, got);
        return int64_t(got);
    };
    settings.size_fn = [](exr_const_context_t, void* user) {
        return int64_t(static_cast<const ExrLines::File*>(user)->bytes.size());
    };
    settings.error_handler_fn = [](exr_const_context_t context, exr_result_t, const char* message) {
        void* user = nullptr;
        if (!context || exr_get_user_data(context, &user) != EXR_ERR_SUCCESS || !user) return;
        const auto* file = static_cast<const ExrLines::File*>(user);
        const std::lock_guard lock(file->mutex);
        file->error = message;
    };
    file_->check(exr_start_read(&file_->context, path.c_str(), &settings));
}

ExrLines::~ExrLines() {
    if (file_->context) exr_finish(&file_->context);
}

void ExrLines::read(int part, int begin, int end, size_t width, const std::vector<Target>& targets) const {
    struct Pipeline {
        exr_context_t context;
        exr_decode_pipeline_t all = EXR_DECODE_PIPELINE_INITIALIZER;
        std::vector<uint8_t> scratch;
        bool made = false;
        ~Pipeline() {
            if (made) exr_decoding_destroy(context, &all);
        }
    } pipeline{file_->context};
    exr_decode_pipeline_t& decode = pipeline.all;
    exr_compression_t compression = EXR_COMPRESSION_NONE;
    file_->check(exr_get_compression(file_->context, part, &compression));
    int32_t rows = 1;
    file_->check(exr_get_scanlines_per_chunk(file_->context, part, &rows));
    // Both libraries read the headers, and may choose differently if an attribute occurs twice.
    const auto mustBe = [&](bool same) {
        if (!same)
            throw FileError(file_->path, "is damaged: its chunks are of another size than its picture");
    };
    for (int y = begin; y < end; y += rows) {
        exr_chunk_info_t chunk;
        file_->check(exr_read_scanline_chunk_info(file_->context, part, y, &chunk));
        mustBe(chunk.start_y == y && chunk.height == std::min(rows, end - y) && size_t(chunk.width) == width);
        const bool first = !pipeline.made;
        file_->check(first ? exr_decoding_initialize(file_->context, part, &chunk, &decode)
                           : exr_decoding_update(file_->context, part, &chunk, &decode));
        pipeline.made = true;
        uint64_t bytes = 0;
        for (int16_t c = 0; c < decode.channel_count; ++c)
            bytes += uint64_t(chunk.height) * uint64_t(decode.channels[c].width) *
                     uint64_t(decode.channels[c].bytes_per_element);
        mustBe(chunk.unpacked_size == bytes && chunk.packed_size <= bytes &&
               chunk.packed_size <= file_->bytes.size());
        mustBe(compression != EXR_COMPRESSION_NONE || chunk.packed_size == bytes);
        for (int16_t c = 0; c < decode.channel_count; ++c) {
            exr_coding_channel_info_t& channel = decode.channels[c];
            channel.decode_to_ptr = nullptr;
            const auto target =
                std::ranges::find(targets, std::string_view(channel.channel_name), &Target::name);
            if (target == targets.end()) continue;
            mustBe(size_t(channel.width) == width && channel.height == chunk.height);
            channel.decode_to_ptr =
                reinterpret_cast<uint8_t*>(target->first + size_t(y - begin) * target->rowStride);
            channel.user_bytes_per_element = sizeof(float);
            channel.user_data_type = EXR_PIXEL_FLOAT;
            channel.user_pixel_stride = int32_t(target->pixelStride * sizeof(float));
            channel.user_line_stride = int32_t(target->rowStride * sizeof(float));
        }
        if (first) {
            file_->check(exr_decoding_choose_default_routines(file_->context, part, &decode));
            // OpenEXR's own function fails if some channels are not wanted. Null if values are read directly.
            if (decode.unpack_and_convert_fn) decode.unpack_and_convert_fn = unpack;
            decode.decoding_user_data = &pipeline.scratch;
            if (compression == EXR_COMPRESSION_RLE)
                decode.decompress_fn = decompress<undoRle>;
            else if (compression == EXR_COMPRESSION_ZIP || compression == EXR_COMPRESSION_ZIPS)
                decode.decompress_fn = decompress<undoZip>;
        }
        file_->check(exr_decoding_run(file_->context, part, &decode));
    }
}

}  // namespace pellucid::io
