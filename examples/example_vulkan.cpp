// Memory of Vulkan that Pellucid works on in place, without a window. Vulkan fills a G-buffer, a finger lit
// from its side, as a renderer would draw one, and Pellucid writes radiance into the same memory: shared by
// cl_khr_external_memory, as an opaque descriptor or a dma-buf, where the OpenCL device has it and is the
// same GPU, else mapped memory of the host. Fails unless the picture has the bits of one that is made from a
// copy; ends with 77 without Vulkan.
#define CL_TARGET_OPENCL_VERSION 300
#include <CL/cl.h>
#include <CL/cl_ext.h>

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <pellucid/pellucid.hpp>
#include <vulkan/vulkan.hpp>

using namespace pellucid;

namespace {

// One allocation holds all images.
constexpr uint32_t side = 256;
constexpr uint64_t depthAt = uint64_t(side) * side * 16, radianceAt = depthAt + depthAt / 4,
                   allBytes = radianceAt + depthAt;

// A row of a finger of 16 mm in a picture of 20 mm; all rows are alike.
struct Row {
    float normals[side][4]{};  // and the id of the material
    float depth[side];
};
Row fingerRow() {
    Row row;
    for (uint32_t x = 0; x < side; ++x) {
        const float u = (20 * (float(x) + 0.5f) / side - 10) / 8, w = std::sqrt(std::fmax(0.0f, 1 - u * u));
        row.depth[x] = w > 0 ? 0.5f - 8 * w / 20 : 1;
        if (w > 0) row.normals[x][0] = u, row.normals[x][2] = w, row.normals[x][3] = 1;
    }
    return row;
}

void shade(const Device& device, const Buffer& memory) {
    const auto image = [&](PelFormat format, uint64_t offset) {
        return imageDesc(memory, format, side, side, offset);
    };
    PelImageDesc ids = image(PEL_FORMAT_R32F, 12);
    ids.pixelStride = 16;
    PelCamera camera = pelCameraDefaults();
    camera.inverseViewProjection[0] = camera.inverseViewProjection[5] = 10;
    camera.inverseViewProjection[10] = -20, camera.inverseViewProjection[11] = 10;
    Shader shader(device);
    shader.set(PEL_SLOT_NORMAL_SHADING, image(PEL_FORMAT_RGBA32F, 0))
        .set(PEL_SLOT_MATERIAL, ids)
        .set(PEL_SLOT_DEPTH, image(PEL_FORMAT_R32F, depthAt))
        .set(PEL_SLOT_RADIANCE, image(PEL_FORMAT_RGBA32F, radianceAt))
        .setMaterial(1, material(Profile::named("skin-burley"), {0.75f, 0.5f, 0.4f}))
        .set({directionalLight({1, 0, 0.2f}, {1, 1, 1})})
        .set(camera)
        .commit()
        .execute();
}

// Vulkan's work: the first row, and copies of it. `owner`: the family of queues that has the memory then.
void fill(vk::Device device, vk::Buffer buffer, uint32_t owner) {
    const auto pool = device.createCommandPoolUnique({});
    const auto commands = std::move(device.allocateCommandBuffersUnique({*pool, {}, 1})[0]);
    const auto barrier = [&](vk::AccessFlags next, vk::PipelineStageFlags stage, uint32_t to) {
        const vk::BufferMemoryBarrier written(vk::AccessFlagBits::eTransferWrite, next, 0, to, buffer, 0,
                                              VK_WHOLE_SIZE);
        commands->pipelineBarrier(vk::PipelineStageFlagBits::eTransfer, stage, {}, {}, written, {});
    };
    const Row row = fingerRow();
    std::vector<vk::BufferCopy> copies;
    for (uint64_t y = 1; y < side; ++y) {
        copies.emplace_back(0, y * sizeof row.normals, sizeof row.normals);
        copies.emplace_back(depthAt, depthAt + y * sizeof row.depth, sizeof row.depth);
    }
    commands->begin(vk::CommandBufferBeginInfo());
    commands->fillBuffer(buffer, radianceAt, allBytes - radianceAt, 0);
    commands->updateBuffer(buffer, 0, sizeof row.normals, row.normals);
    commands->updateBuffer(buffer, depthAt, sizeof row.depth, row.depth);
    barrier(vk::AccessFlagBits::eTransferRead, vk::PipelineStageFlagBits::eTransfer, 0);
    commands->copyBuffer(buffer, buffer, copies);
    barrier(vk::AccessFlagBits::eMemoryRead, vk::PipelineStageFlagBits::eAllCommands, owner);
    commands->end();
    const vk::Queue queue = device.getQueue(0, 0);
    queue.submit(vk::SubmitInfo({}, {}, *commands));
    queue.waitIdle();
}

struct Way {
    const char *openCl, *vulkan;  // extensions
    cl_mem_properties import;
    vk::ExternalMemoryHandleTypeFlagBits handle;
};
constexpr Way ways[] = {
    {"cl_khr_external_memory_opaque_fd", VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME,
     CL_EXTERNAL_MEMORY_HANDLE_OPAQUE_FD_KHR, vk::ExternalMemoryHandleTypeFlagBits::eOpaqueFd},
    {"cl_khr_external_memory_dma_buf", VK_EXT_EXTERNAL_MEMORY_DMA_BUF_EXTENSION_NAME,
     CL_EXTERNAL_MEMORY_HANDLE_DMA_BUF_KHR, vk::ExternalMemoryHandleTypeFlagBits::eDmaBufEXT}};

// The way in which an OpenCL device shares memory of this GPU; nullptr: none.
const Way* wayOf(cl_device_id device, vk::PhysicalDevice gpu, const vk::PhysicalDeviceIDProperties& ids) {
    static char openCl[1 << 16];
    cl_uchar uuid[CL_UUID_SIZE_KHR];
    if (clGetDeviceInfo(device, CL_DEVICE_EXTENSIONS, sizeof openCl, openCl, nullptr) ||
        clGetDeviceInfo(device, CL_DEVICE_UUID_KHR, sizeof uuid, uuid, nullptr) ||
        std::memcmp(uuid, ids.deviceUUID, sizeof uuid) != 0)
        return nullptr;
    const auto vulkan = gpu.enumerateDeviceExtensionProperties();
    for (const Way& way : ways)
        if (std::strstr(openCl, way.openCl) && std::any_of(vulkan.begin(), vulkan.end(), [&](const auto& e) {
                return std::strcmp(e.extensionName, way.vulkan) == 0;
            }))
            return &way;
    return nullptr;
}

// "Acquire" before work on memory of somebody else, "Release" after it.
void handOver(const char* which, cl_device_id device, cl_command_queue queue, cl_mem memory) {
    cl_platform_id platform = nullptr;
    clGetDeviceInfo(device, CL_DEVICE_PLATFORM, sizeof platform, static_cast<void*>(&platform), nullptr);
    const std::string name = std::string("clEnqueue") + which + "ExternalMemObjectsKHR";
    const auto call = reinterpret_cast<clEnqueueAcquireExternalMemObjectsKHR_fn>(
        clGetExtensionFunctionAddressForPlatform(platform, name.c_str()));
    if (!call || call(queue, 1, &memory, 0, nullptr, nullptr)) throw std::runtime_error(name + " failed");
}

int run() {
    const vk::ApplicationInfo application("", 0, "", 0, VK_API_VERSION_1_1);
    const vk::UniqueInstance instance = vk::createInstanceUnique({{}, &application});
    const std::vector<vk::PhysicalDevice> gpus = instance->enumeratePhysicalDevices();
    if (gpus.empty()) throw vk::IncompatibleDriverError("no device");
    const vk::PhysicalDevice gpu = gpus[0];
    const auto properties =
        gpu.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceIDProperties>();
    const Device pel;
    void *context = nullptr, *id = nullptr, *queue = nullptr;
    check(pelDeviceGetCl(pel.get(), &context, &id, &queue));
    const Way* const way = wayOf(cl_device_id(id), gpu, properties.get<vk::PhysicalDeviceIDProperties>());

    const float priority = 1;
    const vk::DeviceQueueCreateInfo queues({}, 0, 1, &priority);
    std::vector<const char*> extensions;
    if (way) extensions.push_back(ways[0].vulkan);
    if (way == &ways[1]) extensions.push_back(way->vulkan);
    const vk::UniqueDevice device = gpu.createDeviceUnique({{}, queues, {}, extensions});
    const auto handle = way ? way->handle : ways[0].handle;
    const vk::ExternalMemoryBufferCreateInfo external(handle);
    const vk::ExportMemoryAllocateInfo exported(handle);
    const auto usage = vk::BufferUsageFlagBits::eTransferSrc | vk::BufferUsageFlagBits::eTransferDst;
    vk::BufferCreateInfo size({}, allBytes, usage);
    if (way) size.pNext = &external;
    const vk::UniqueBuffer buffer = device->createBufferUnique(size);
    const vk::MemoryRequirements needs = device->getBufferMemoryRequirements(*buffer);
    const vk::PhysicalDeviceMemoryProperties types = gpu.getMemoryProperties();
    using Flag = vk::MemoryPropertyFlagBits;
    const vk::MemoryPropertyFlags wanted =
        way ? Flag::eDeviceLocal : Flag::eHostVisible | Flag::eHostCoherent;
    uint32_t type = 0;
    while (!(needs.memoryTypeBits >> type & 1) ||
           (types.memoryTypes.at(type).propertyFlags & wanted) != wanted)
        ++type;
    const vk::UniqueDeviceMemory memory =
        device->allocateMemoryUnique({needs.size, type, way ? &exported : nullptr});
    device->bindBufferMemory(*buffer, *memory, 0);

    Buffer image;
    cl_mem imported = nullptr;
    if (way) {
        fill(*device, *buffer, VK_QUEUE_FAMILY_EXTERNAL);
        const auto fdOf = reinterpret_cast<PFN_vkGetMemoryFdKHR>(device->getProcAddr("vkGetMemoryFdKHR"));
        const VkMemoryGetFdInfoKHR info = vk::MemoryGetFdInfoKHR(*memory, handle);
        int fd = -1;
        fdOf(*device, &info, &fd);
        const cl_mem_properties from[] = {way->import, cl_mem_properties(fd), 0};
        imported = clCreateBufferWithProperties(cl_context(context), from, CL_MEM_READ_WRITE, allBytes,
                                                nullptr, nullptr);
        if (way == &ways[1]) close(fd);  // the cl_mem owns an opaque one
        handOver("Acquire", cl_device_id(id), cl_command_queue(queue), imported);
        image = Buffer::fromCl(pel, imported);
    } else {
        image = Buffer::fromHost(pel, device->mapMemory(*memory, 0, VK_WHOLE_SIZE), allBytes);
        image.map();  // the host's, and so Vulkan's
        fill(*device, *buffer, 0);
        image.unmap();
    }
    const Buffer copy(pel, image.readAll<float>());
    shade(pel, image);
    shade(pel, copy);
    const std::vector<float> all = image.readAll<float>();
    // Half a millimetre beyond the terminator.
    const float* const dark = &all[radianceAt / 4 + 4 * (side * side / 2 + side / 2 - 28)];
    const bool right = all == copy.readAll<float>() && dark[0] > dark[2];
    std::printf("%s fills, %s shades, by %s: %s\n", properties.get<>().properties.deviceName.data(),
                pel.info().name, way ? way->openCl : "mapped memory",
                right ? "the picture of a copy" : "WRONG");
    if (imported) {
        handOver("Release", cl_device_id(id), cl_command_queue(queue), imported);
        pel.finish();
        clReleaseMemObject(imported);
    }
    return right ? 0 : 1;
}

}  // namespace

int main() try { return run(); } catch (const vk::IncompatibleDriverError&) {
    return std::puts("SKIPPED: there is no Vulkan device"), 77;
} catch (const std::exception& e) {
    return std::fprintf(stderr, "example_vulkan: %s\n", e.what()), 1;
}
