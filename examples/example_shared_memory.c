/* Memory of somebody else that Pellucid uses in place, by way of a cl_mem of the host's own: a dma-buf
 * (cl_khr_external_memory_dma_buf; Vulkan's exported memory is imported the same way). It runs where a driver
 * has it, and says so where none has: then the renderer's images are copied, by pelBufferWrite or a buffer
 * over mapped host memory. example_vulkan.cpp has the same for Vulkan, deferred_gl for OpenGL. */
#define _GNU_SOURCE
#define CL_TARGET_OPENCL_VERSION 300
#include <CL/cl.h>
#include <CL/cl_ext.h>
#include <fcntl.h>
#include <math.h>
#include <pellucid/pellucid.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

/* The result: six curvatures of an octahedron of radius 2, 1/2 each. */
enum { VERTICES = 6, RESULT_BYTES = 4096 };

static int has(cl_device_id device, const char* extension) {
    static char all[65536];
    if (clGetDeviceInfo(device, CL_DEVICE_EXTENSIONS, sizeof all, all, NULL)) return 0;
    const char* at = strstr(all, extension);
    const char after = at ? at[strlen(extension)] : 'x';
    return at && (after == ' ' || after == '\0');
}

/* Pellucid on the host's context, device and queue: curvature into the host's cl_mem. */
static int curvatureInto(cl_context context, cl_device_id device, cl_command_queue queue, cl_mem memory) {
    const float positions[18] = {2, 0, 0, -2, 0, 0, 0, 2, 0, 0, -2, 0, 0, 0, 2, 0, 0, -2};
    const float normals[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    const uint32_t triangles[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    PelDevice pel = NULL;
    PelMeshTopology topology = NULL;
    PelBuffer p = NULL, n = NULL, out = NULL;
    PelMeshTopologyDesc mesh = pelMeshTopologyDescDefaults();
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    mesh.numVertices = VERTICES, mesh.indices = triangles, mesh.numIndices = 24;
    params.estimator = PEL_CURVATURE_EDGE;
    int failed = pelDeviceCreateFromCl(context, device, queue, &pel) ||
                 pelMeshTopologyCreate(pel, &mesh, &topology, NULL) ||
                 pelBufferCreate(pel, sizeof positions, positions, &p) ||
                 pelBufferCreate(pel, sizeof normals, normals, &n) ||
                 pelBufferCreateFromCl(pel, memory, &out); /* the memory that is shared */
    if (!failed) {
        const PelVertexView at = {p, 0, 0, VERTICES}, facing = {n, 0, 0, VERTICES},
                            result = {out, 0, 0, VERTICES};
        failed = pelMeshCurvature(topology, &params, &at, &facing, &result, NULL, NULL) != PEL_SUCCESS;
    }
    if (failed) fprintf(stderr, "%s\n", pelGetErrorMessage());
    pelBufferRelease(p), pelBufferRelease(n), pelBufferRelease(out), pelMeshTopologyRelease(topology),
        pelDeviceRelease(pel);
    return !failed;
}

static int isRight(const float* values, const char* how) {
    int i, right = 1;
    for (i = 0; i < VERTICES; ++i) right = right && fabsf(values[i] - 0.5f) < 1e-5f;
    printf("  %s: curvature %g, expected 0.5: %s\n", how, values[0], right ? "shared" : "WRONG");
    return right;
}

/* ---- A dma-buf, here of pages of this process by /dev/udmabuf. -1: there is none. */

struct UdmabufCreate { /* struct udmabuf_create of linux/udmabuf.h */
    uint32_t memfd, flags;
    uint64_t offset, size;
};

static int dmaBuf(int* pages) {
    *pages = memfd_create("pellucid", MFD_ALLOW_SEALING);
    const int maker = open("/dev/udmabuf", O_RDWR);
    struct UdmabufCreate create = {(uint32_t)*pages, 1 /* close on exec */, 0, RESULT_BYTES};
    if (*pages < 0 || maker < 0 || ftruncate(*pages, RESULT_BYTES) ||
        fcntl(*pages, F_ADD_SEALS, F_SEAL_SHRINK))
        return -1;
    const int fd = ioctl(maker, _IOW('u', 0x42, struct UdmabufCreate), &create);
    close(maker);
    return fd;
}

static int shareDmaBuf(cl_platform_id platform, cl_device_id device) {
    if (!has(device, "cl_khr_external_memory_dma_buf"))
        return printf("  no cl_khr_external_memory_dma_buf\n"), 1;
    int pages;
    const int fd = dmaBuf(&pages);
    if (fd < 0) return printf("  cl_khr_external_memory_dma_buf, but no /dev/udmabuf to try it with\n"), 1;
    typedef cl_int(CL_API_CALL * Pass)(cl_command_queue, cl_uint, const cl_mem*, cl_uint, const cl_event*,
                                       cl_event*);
    Pass acquire, release;
    *(void**)&acquire =
        clGetExtensionFunctionAddressForPlatform(platform, "clEnqueueAcquireExternalMemObjectsKHR");
    *(void**)&release =
        clGetExtensionFunctionAddressForPlatform(platform, "clEnqueueReleaseExternalMemObjectsKHR");
    cl_int error = CL_SUCCESS;
    cl_context context = clCreateContext(NULL, 1, &device, NULL, NULL, &error);
    cl_command_queue queue = clCreateCommandQueueWithProperties(context, device, NULL, &error);
    const cl_mem_properties properties[] = {CL_EXTERNAL_MEMORY_HANDLE_DMA_BUF_KHR, (cl_mem_properties)fd, 0};
    cl_mem memory =
        clCreateBufferWithProperties(context, properties, CL_MEM_READ_WRITE, RESULT_BYTES, NULL, &error);
    int right = 0;
    if (error || !acquire || !release) {
        printf("  the driver refuses the dma-buf: error %d\n", error);
    } else if (!acquire(queue, 1, &memory, 0, NULL, NULL) && curvatureInto(context, device, queue, memory) &&
               !release(queue, 1, &memory, 0, NULL, NULL) && !clFinish(queue)) {
        const float* seen = mmap(NULL, RESULT_BYTES, PROT_READ, MAP_SHARED, pages, 0);
        right = seen != MAP_FAILED && isRight(seen, "dma-buf");
    }
    if (memory) clReleaseMemObject(memory);
    clReleaseCommandQueue(queue), clReleaseContext(context), close(pages);
    return right;
}

int main(void) {
    cl_platform_id platforms[16];
    cl_uint numPlatforms = 0, p, d;
    int right = 1;
    if (clGetPlatformIDs(16, platforms, &numPlatforms)) numPlatforms = 0;
    for (p = 0; p < numPlatforms && p < 16; ++p) {
        cl_device_id devices[16];
        cl_uint numDevices = 0;
        if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, 16, devices, &numDevices)) continue;
        for (d = 0; d < numDevices && d < 16; ++d) {
            char name[256] = "";
            clGetDeviceInfo(devices[d], CL_DEVICE_NAME, sizeof name, name, NULL);
            printf("%s\n", name);
            right = shareDmaBuf(platforms[p], devices[d]) && right;
            printf("  %s cl_khr_external_memory_opaque_fd (Vulkan)\n",
                   has(devices[d], "cl_khr_external_memory_opaque_fd") ? "has" : "no");
        }
    }
    if (!numPlatforms) printf("no OpenCL platform\n");
    return right ? 0 : 1;
}
