/* A renderer's own kernel includes a shading term of kernels/lib, like a shader file: here
 * Kelemen and Szirmay-Kalos' specular with a light and a colour of the renderer's own. PELLUCID_KERNELS is
 * the folder to include from: pellucid_KERNELS in CMake, `pkg-config --variable=kernels pellucid` elsewhere.
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <math.h>
#include <stdio.h>

static const char* source =
    "#include \"lib/shading/specular.clh\"\n" /* without PEL_WIDTH its functions take one value each */
    "__kernel void highlights(__global const float* cosines, __global float* result) {\n"
    "    const size_t i = get_global_id(0);\n"
    "    const float c = cosines[i], s = sqrt(1.0f - c * c);\n"
    "    const Vec3w n = vec3(0.0f, 0.0f, 1.0f), light = vec3(s, 0.0f, c), eye = vec3(-s, 0.0f, c);\n"
    "    result[i] = 2.5f * specularKsk(n, light, eye, dot3(n, light), 0.3f, 0.028f);\n"
    "}\n";

int main(void) {
    cl_platform_id platform;
    cl_device_id device;
    if (clGetPlatformIDs(1, &platform, NULL) ||
        clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL))
        return fprintf(stderr, "no OpenCL device\n"), 1;
    cl_context context = clCreateContext(NULL, 1, &device, NULL, NULL, NULL);
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, NULL);
    cl_program program = clCreateProgramWithSource(context, 1, &source, NULL, NULL);
    if (clBuildProgram(program, 1, &device, "-cl-std=CL1.2 -I" PELLUCID_KERNELS, NULL, NULL)) {
        char log[4096] = "";
        clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, sizeof log, log, NULL);
        return fprintf(stderr, "%s\n", log), 1;
    }
    enum { COUNT = 64 };
    float cosines[COUNT], result[COUNT];
    for (int i = 0; i < COUNT; ++i) cosines[i] = (float)(i + 1) / COUNT;
    cl_mem in =
        clCreateBuffer(context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof cosines, cosines, NULL);
    cl_mem out = clCreateBuffer(context, CL_MEM_WRITE_ONLY, sizeof result, NULL, NULL);
    cl_kernel kernel = clCreateKernel(program, "highlights", NULL);
    clSetKernelArg(kernel, 0, sizeof in, &in);
    clSetKernelArg(kernel, 1, sizeof out, &out);
    const size_t count = COUNT;
    if (clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &count, NULL, 0, NULL, NULL) ||
        clEnqueueReadBuffer(queue, out, CL_TRUE, 0, sizeof result, result, 0, NULL, NULL))
        return fprintf(stderr, "the kernel failed\n"), 1;

    /* In the mirror's direction the half vector is the normal: (N.L) F / (m^2 |L + V|^2). */
    float worst = 0;
    for (int i = 0; i < COUNT; ++i) {
        const double c = cosines[i], fresnel = 0.028 + 0.972 * pow(1 - c, 5);
        const double expected = 2.5 * c * fresnel / (0.09 * 4 * c * c);
        worst = fmaxf(worst, (float)fabs(result[i] / expected - 1));
    }
    printf("%g at the mirror's angle of 60 degrees; largest difference from the formula %.1e\n",
           result[COUNT / 2 - 1], worst);
    clReleaseKernel(kernel);
    clReleaseMemObject(in);
    clReleaseMemObject(out);
    clReleaseProgram(program);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    return worst < 1e-4f ? 0 : 1;
}
