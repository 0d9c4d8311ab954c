/* A renderer that already has an OpenCL context and queue shares them: Pellucid's work goes to that queue, in
 * order with the renderer's own commands, and results stay in the renderer's cl_mem. Here: curvature into a
 * cl_mem, one wait in all. */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <math.h>
#include <pellucid/pellucid.h>
#include <stdio.h>

#define CHECK(call) \
    if (call) return fprintf(stderr, "%s: %s\n", #call, pelGetErrorMessage()), 1

int main(void) {
    /* The renderer's side. */
    cl_platform_id platform;
    cl_device_id device;
    if (clGetPlatformIDs(1, &platform, NULL) ||
        clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL))
        return fprintf(stderr, "no OpenCL device\n"), 1;
    cl_context context = clCreateContext(NULL, 1, &device, NULL, NULL, NULL);
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, NULL);
    /* An octahedron of radius 2: six vertices whose normals are their directions. */
    const float positions[18] = {2, 0, 0, -2, 0, 0, 0, 2, 0, 0, -2, 0, 0, 0, 2, 0, 0, -2};
    const float normals[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    const uint32_t triangles[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    cl_mem vertices =
        clCreateBuffer(context, CL_MEM_READ_ONLY, sizeof positions + sizeof normals, NULL, NULL);
    cl_mem result = clCreateBuffer(context, CL_MEM_READ_WRITE, 6 * sizeof(float), NULL, NULL);
    cl_event uploaded;
    clEnqueueWriteBuffer(queue, vertices, CL_FALSE, 0, sizeof positions, positions, 0, NULL, NULL);
    clEnqueueWriteBuffer(queue, vertices, CL_FALSE, sizeof positions, sizeof normals, normals, 0, NULL,
                         &uploaded);

    /* Pellucid on the same objects; it retains what it keeps. */
    PelDevice pel;
    CHECK(pelDeviceCreateFromCl(context, device, queue, &pel));
    PelMeshTopologyDesc mesh = pelMeshTopologyDescDefaults();
    mesh.numVertices = 6;
    mesh.indices = triangles;
    mesh.numIndices = 24;
    PelMeshTopology topology;
    CHECK(pelMeshTopologyCreate(pel, &mesh, &topology, NULL));
    PelBuffer in, out;
    CHECK(pelBufferCreateFromCl(pel, vertices, &in));
    CHECK(pelBufferCreateFromCl(pel, result, &out));
    const PelVertexView p = {in, 0, 0, 6}, n = {in, sizeof positions, 0, 6}, c = {out, 0, 0, 6};
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    /* exact on a sphere's own normals, however few vertices there are */
    params.estimator = PEL_CURVATURE_EDGE;
    PelEvent wait, done;
    CHECK(pelEventCreateFromCl(pel, uploaded, &wait));
    const PelSubmit submit = {&wait, 1, &done};
    CHECK(pelMeshCurvature(topology, &params, &p, &n, &c, NULL, &submit));

    /* And back: the renderer waits for Pellucid's event in its own command. */
    void* event;
    CHECK(pelEventGetCl(done, &event));
    cl_event finished = (cl_event)event;
    float curvature[6];
    if (clEnqueueReadBuffer(queue, result, CL_TRUE, 0, sizeof curvature, curvature, 1, &finished, NULL))
        return fprintf(stderr, "the read failed\n"), 1;
    printf("curvature %g, expected 0.5 everywhere\n", curvature[0]);

    pelEventRelease(wait);
    pelEventRelease(done);
    pelBufferRelease(in);
    pelBufferRelease(out);
    pelMeshTopologyRelease(topology);
    pelDeviceRelease(pel);
    clReleaseEvent(uploaded);
    clReleaseMemObject(vertices);
    clReleaseMemObject(result);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    for (int i = 0; i < 6; ++i)
        if (fabsf(curvature[i] - 0.5f) > 1e-5f) return 1;
    return 0;
}
