/* Pellucid: subsurface scattering for deferred renderers, on OpenCL.
 *
 * This header is the only binary interface. pellucid.hpp wraps it for C++.
 *
 * Conventions that hold everywhere
 * - Lengths (positions, radii, widths, thickness) are in any one unit, the same for all; curvature is in
 *   1/length. Defaults are in millimetres.
 * - Colours are linear RGB.
 * - Matrices are 16 floats in row-major order and multiply column vectors: clip = M * (x, y, z, 1).
 * - Every structure that may grow starts with structSize; the pel*Defaults() functions fill it and every
 *   other field.
 * - Handles are reference-counted: each Create or Retain is paired with a Release. Objects keep what they use
 *   alive. Handle values are never reused: NULL and released or invalid handles give
 *   PEL_ERROR_INVALID_ARGUMENT. Retain and Release return nothing; pelGetErrorMessage and the callback report
 *   their errors.
 * - After fork, calls of the child return PEL_ERROR_INVALID_STATE if the parent had used OpenCL before.
 * - A function that can fail returns PelError. On an error no output is written and all objects stay usable;
 *   pelGetErrorMessage() says what was wrong, where, and what would be right.
 * - Functions may be called from any thread. One object may be used by several threads at a time, except that
 *   a PelShader, PelScatter or PelTextureScatter is used by one thread at a time. */
#ifndef PELLUCID_H
#define PELLUCID_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PEL_VERSION_MAJOR 0
#define PEL_VERSION_MINOR 1
#define PEL_VERSION_PATCH 0

#if defined(_WIN32)
#ifdef PELLUCID_BUILD
#define PEL_API __declspec(dllexport)
#else
#define PEL_API __declspec(dllimport)
#endif
#else
#define PEL_API __attribute__((visibility("default")))
#endif

/* ---- Errors --------------------- */

typedef enum PelError {
    PEL_SUCCESS = 0,
    PEL_ERROR_INVALID_ARGUMENT = 1, /* a value, a size or a combination that the documentation excludes */
    PEL_ERROR_INVALID_STATE = 2,    /* the call is valid, but not now (execute before commit) */
    PEL_ERROR_NO_DEVICE = 3,        /* no OpenCL device, or none that matches the selector */
    PEL_ERROR_OUT_OF_MEMORY = 4,    /* host or device */
    PEL_ERROR_DEVICE = 5,           /* OpenCL reported a failure, or a kernel did not build */
    PEL_ERROR_UNSUPPORTED = 6,      /* valid, but this device or this build cannot do it */
    PEL_ERROR_CANCELLED = 7,        /* a progress callback returned 0 */
    PEL_ERROR_UNKNOWN = 8           /* a fault in the library */
} PelError;

/* The name of an error code, such as "PEL_ERROR_NO_DEVICE". Never NULL; static storage. */
PEL_API const char* pelErrorName(PelError error);

/* The message of the last failed call on this thread, or "" if none failed yet. Valid until this thread's
 * next call. */
PEL_API const char* pelGetErrorMessage(void);

/* Called on the failing thread with each error before it is returned. NULL removes it. One for the whole
 * process. */
typedef void (*PelErrorCallback)(void* user, PelError error, const char* message);
PEL_API void pelSetErrorCallback(PelErrorCallback callback, void* user);

typedef enum PelLogLevel { PEL_LOG_ERROR = 0, PEL_LOG_WARNING = 1 } PelLogLevel;

/* Called on the calling thread with each error before it is returned, and with each sentence of
 * pelShaderGetWarnings during the commit. `object`: the name of the first object of the call that has one, or
 * "". NULL removes it. One for the whole process, beside the error callback. */
typedef void (*PelLogCallback)(void* user, PelLogLevel level, const char* object, const char* text);
PEL_API void pelSetLogCallback(PelLogCallback callback, void* user);

/* Names an object, such as "hero's shader", for the log; error messages of its calls begin with the name. Any
 * handle will do. NULL or "" removes the name. */
PEL_API PelError pelSetName(void* object, const char* name);

/* The library's version as one number: major * 10000 + minor * 100 + patch. */
PEL_API uint32_t pelVersion(void);

/* ---- Devices --------------------- */

typedef struct PelDeviceObject* PelDevice;
typedef struct PelEventObject* PelEvent;

typedef enum PelDeviceType {
    PEL_DEVICE_CPU = 0,
    PEL_DEVICE_GPU = 1,
    PEL_DEVICE_ACCELERATOR = 2
} PelDeviceType;

typedef struct PelDeviceInfo {
    uint32_t structSize;
    uint32_t index; /* position in the list, for selectors; UINT32_MAX for a host's own context */
    PelDeviceType type;
    uint32_t computeUnits;
    uint32_t clockMhz;
    uint32_t preferredFloatWidth; /* CL_DEVICE_PREFERRED_VECTOR_WIDTH_FLOAT, lanes */
    uint32_t mathWidth;           /* lanes per work-item that Pellucid's kernels use here: 1, 8 or 16 */
    uint32_t sharedMemory; /* 1: host and device share memory, buffers from host memory are not copied */
    uint64_t globalMemoryBytes;
    uint64_t maxAllocationBytes;
    uint64_t localMemoryBytes;
    uint64_t maxWorkGroupSize;
    char name[128];
    char vendor[128];
    char platform[128];
    char version[128]; /* CL_DEVICE_VERSION */
    char driver[128];
    char quirks[256]; /* workarounds in use, separated by "; "; "" if none */
} PelDeviceInfo;

/* Counts the OpenCL devices of this machine. 0 devices is a success here. */
PEL_API PelError pelDeviceCount(uint32_t* count);

/* Describes device `index` (0 <= index < count). Set info->structSize first (pelDeviceInfoDefaults). */
PEL_API PelError pelDeviceEnumerate(uint32_t index, PelDeviceInfo* info);

/* Makes a device. `selector`: a number in the list; "gpu", "cpu" or "accelerator"; or a part of the name or
 * platform, letter case ignored. NULL or "": the environment variable PELLUCID_DEVICE, and without it the
 * best GPU, else the best CPU. Errors: PEL_ERROR_NO_DEVICE (the message lists the devices found, or names the
 * package that provides one). */
PEL_API PelError pelDeviceCreate(const char* selector, PelDevice* device);

/* A host's own device memory: returns a cl_mem buffer of the context, of at least `bytes`, or NULL if there
 * is none. The library takes over the reference; clSetMemObjectDestructorCallback reports its release.
 */
typedef void* (*PelAllocateCallback)(void* user, void* clContext, size_t bytes);

typedef struct PelDeviceDesc {
    uint32_t structSize;
    /* 1: kernels are timed by OpenCL's profiling, which the milliseconds of PelDeviceStats, PelShaderStats
     * and PelPassStats need; 0: not. Default 2: the environment variable PELLUCID_PROFILING decides; 1
     * without it */
    uint32_t profiling;
    const char* selector; /* as of pelDeviceCreate; NULL */
    /* allocates all device memory; called on the calling thread, and on threads of PelWarmUp.threads and
     * PelShaderOptions.buildInBackground; NULL: OpenCL's */
    PelAllocateCallback allocate;
    void* allocateUser;
} PelDeviceDesc;
/* pelDeviceCreate with options. */
PEL_API PelError pelDeviceCreateWith(const PelDeviceDesc* desc, PelDevice* device);

/* Makes a device from the caller's own cl_context, cl_device_id and in-order cl_command_queue (retained; all
 * needed). All work goes to that queue. */
PEL_API PelError pelDeviceCreateFromCl(void* clContext, void* clDeviceId, void* clCommandQueue,
                                       PelDevice* device);

PEL_API void pelDeviceRetain(PelDevice device);
PEL_API void pelDeviceRelease(PelDevice device); /* NULL does nothing, as for every Release */
PEL_API PelError pelDeviceGetInfo(PelDevice device, PelDeviceInfo* info);

/* The OpenCL objects behind a device; any pointer may be NULL. Not retained for the caller. */
PEL_API PelError pelDeviceGetCl(PelDevice device, void** clContext, void** clDeviceId, void** clCommandQueue);

/* Waits until everything submitted to this device has finished. */
PEL_API PelError pelDeviceFinish(PelDevice device);

/* Counters of a device since it was made, and the time its kernels ran. Monotonic: subtract two readings. */
typedef struct PelDeviceStats {
    uint32_t structSize;
    uint32_t programsBuilt; /* OpenCL programs compiled or loaded from a cache */
    uint64_t launches;      /* kernels enqueued */
    uint64_t bytesToDevice; /* copied from the host; memory shared in place is not counted */
    uint64_t bytesToHost;
    uint64_t bytesAllocated; /* device memory allocated by the library, in total over time */
    /* device time of finished kernels, from OpenCL profiling; 0 on a queue without it */
    double kernelMilliseconds;
    double buildMilliseconds; /* host time spent in building programs */
    /* of programsBuilt: from binaries that this library keeps on disk (docs/guide/devices.md) */
    uint32_t programsLoaded;
    uint32_t programsStored; /* of programsBuilt: compiled, and their binaries written there */
} PelDeviceStats;
/* Waits for submitted work first, so that kernelMilliseconds is complete. */
PEL_API PelError pelDeviceGetStats(PelDevice device, PelDeviceStats* stats);

/* Called during long work, on the calling thread, with a fraction in [0, 1] and the name of the step. Return
 * 0 to cancel: the call then returns PEL_ERROR_CANCELLED. One per device; NULL removes it. */
typedef int (*PelProgressCallback)(void* user, double fraction, const char* what);
PEL_API PelError pelDeviceSetProgress(PelDevice device, PelProgressCallback callback, void* user);

/* ---- Submission --------------------- */

/* How a call that does work is submitted. NULL: it blocks until the result is there. Otherwise it returns
 * once the work is queued after `waits`; memory given to it must stay valid until `done` (or, with done NULL,
 * pelDeviceFinish) reports the end. */
typedef struct PelSubmit {
    const PelEvent* waits; /* numWaits events, of this device */
    uint32_t numWaits;
    PelEvent* done; /* NULL, or receives an event that the caller releases */
} PelSubmit;

PEL_API PelError pelEventCreateFromCl(PelDevice device, void* clEvent, PelEvent* event); /* retains clEvent */
PEL_API PelError pelEventGetCl(PelEvent event, void** clEvent); /* not retained for the caller */
/* Waits for the work. Errors: PEL_ERROR_DEVICE if it failed. */
PEL_API PelError pelEventWait(PelEvent event);
PEL_API PelError pelEventIsDone(PelEvent event, int* done);
PEL_API void pelEventRetain(PelEvent event);
PEL_API void pelEventRelease(PelEvent event);

/* ---- Buffers --------------------- */

typedef struct PelBufferObject* PelBuffer;

/* Memory that the library owns, `bytes` > 0 long; `initial` (bytes long, or NULL for zeros) is copied. */
PEL_API PelError pelBufferCreate(PelDevice device, size_t bytes, const void* initial, PelBuffer* buffer);

/* The caller's host memory, in place. The caller keeps it alive until the buffer is released and its work is
 * done, and accesses it only while the buffer is mapped (pelBufferMap). If host and device share memory
 * nothing is copied; otherwise mapping and unmapping copy it. Alignment to 4096 bytes avoids a copy on some
 * devices. */
PEL_API PelError pelBufferCreateFromHost(PelDevice device, void* memory, size_t bytes, PelBuffer* buffer);

/* The caller's cl_mem, of the device's context (retained): a buffer; or a 2D image, such as a texture that is
 * shared with a graphics API. Of an image the library keeps a copy: rows of texels without gaps, in the
 * image's own format, initially zeros. Each execution of a PelShader or a PelScatter first copies its
 * textures there, and afterwards copies textures that it wrote back, as a whole; other calls see the copy as
 * the last execution left it. So the host acquires shared textures before an execution and releases them
 * after it. Errors: PEL_ERROR_INVALID_ARGUMENT for other kinds of images. */
PEL_API PelError pelBufferCreateFromCl(PelDevice device, void* clMem, PelBuffer* buffer);

PEL_API void pelBufferRetain(PelBuffer buffer);
PEL_API void pelBufferRelease(PelBuffer buffer);
PEL_API PelError pelBufferGetSize(PelBuffer buffer, size_t* bytes);
PEL_API PelError pelBufferGetCl(PelBuffer buffer, void** clMem); /* not retained for the caller */
PEL_API PelError pelBufferRead(PelBuffer buffer, size_t offset, size_t bytes, void* destination,
                               const PelSubmit* submit);
PEL_API PelError pelBufferWrite(PelBuffer buffer, size_t offset, size_t bytes, const void* source,
                                const PelSubmit* submit);
/* Makes the whole buffer visible to the host until pelBufferUnmap; for a buffer from host memory it is that
 * memory. Waits for submitted work. Maps nest. */
PEL_API PelError pelBufferMap(PelBuffer buffer, void** memory);
PEL_API PelError pelBufferUnmap(PelBuffer buffer);

/* ---- Images --------------------- */

/* Components are stored in the order named. A component that a slot needs and the format lacks is an error;
 * additional ones are ignored, and kept in outputs. */
typedef enum PelFormat {
    PEL_FORMAT_UNDEFINED = 0,
    PEL_FORMAT_R32F = 1,
    PEL_FORMAT_RG32F = 2,
    PEL_FORMAT_RGB32F = 3,
    PEL_FORMAT_RGBA32F = 4,
    PEL_FORMAT_R16F = 5,
    PEL_FORMAT_RG16F = 6,
    PEL_FORMAT_RGB16F = 7,
    PEL_FORMAT_RGBA16F = 8,
    PEL_FORMAT_R8_UNORM = 9,
    PEL_FORMAT_RGBA8_UNORM = 10, /* as a vector: 2 * value - 1 */
    PEL_FORMAT_RGBA8_SRGB = 11,  /* RGB decoded from sRGB, A linear */
    PEL_FORMAT_R16_UNORM = 12,
    PEL_FORMAT_OCT16X2_SNORM = 13,     /* a unit vector as two signed 16-bit octahedral coordinates */
    PEL_FORMAT_A2B10G10R10_UNORM = 14, /* one uint32, R in the lowest 10 bits; as a vector: 2 * value - 1 */
    PEL_FORMAT_R8_UINT = 15,
    PEL_FORMAT_R16_UINT = 16,
    PEL_FORMAT_R32_UINT = 17,
    PEL_FORMAT_PLANAR_RGB32F = 18 /* three float32 planes, planeStride bytes apart */
} PelFormat;

/* A view of an image inside a buffer, in the layout it already has. Images that are read may share memory. An
 * image that a shader writes may share memory with others only pixel on pixel: in one buffer with the same
 * strides, as the same image or as other components of its pixels. The outputs of pelScreenCurvature and
 * pelScatterExecute may also be other components, but may share no byte with the inputs, except that
 * pelScatterExecute may overwrite its irradiance in the same format. Any other overlap is
 * PEL_ERROR_INVALID_ARGUMENT, also between buffers over the same host memory and parts of one cl_mem. */
typedef struct PelImageDesc {
    uint32_t structSize;
    PelFormat format;
    PelBuffer buffer; /* retained by the object that keeps the view */
    uint32_t width;   /* pixels */
    uint32_t height;
    uint64_t byteOffset;  /* of the first pixel; a multiple of the component size */
    uint64_t pixelStride; /* bytes; 0: tightly packed */
    uint64_t rowStride;   /* bytes; 0: width * pixelStride */
    uint64_t planeStride; /* bytes, planar formats only; 0: height * rowStride */
} PelImageDesc;

/* ---- Meshes --------------------- */

typedef struct PelMeshTopologyObject* PelMeshTopology;

/* Irregularities of a mesh, and how they are handled. */
typedef struct PelMeshReport {
    uint32_t structSize;
    uint32_t vertices;
    uint32_t triangles;
    uint32_t uniquePositions; /* after welding; equals vertices when welding is off */
    uint32_t edges;
    uint32_t borderEdges;          /* of one triangle */
    uint32_t nonManifoldEdges;     /* of three or more triangles: kept, every triangle counts */
    uint32_t unreferencedVertices; /* in no triangle: their curvature is 0 */
    uint32_t degenerateTriangles;  /* a repeated index: skipped */
    uint32_t zeroLengthEdges;      /* too short to measure: skipped; set by curvature */
    /* NaN or Inf: edges to them are skipped, their own curvature is 0; set by curvature */
    uint32_t nonFinitePositions;
    uint32_t nonFiniteNormals; /* NaN, Inf or zero, handled the same way; set by curvature */
    /* edges whose two triangles run along them in the same direction: one of the triangles is reversed, so
     * that normals made from both cancel out (pelMeshOrient) */
    uint32_t inconsistentEdges;
    /* unique positions with too few others around them for a cubic, so that the quadric estimator fitted
     * fewer terms there: estimates may be far off; set by curvature */
    uint32_t lowDegreeFits;
} PelMeshReport;

typedef enum PelWeld { PEL_WELD_NONE = 0, PEL_WELD_EXACT = 1, PEL_WELD_TOLERANCE = 2 } PelWeld;

typedef struct PelMeshTopologyDesc {
    uint32_t structSize;
    uint32_t numVertices;
    const uint32_t* indices; /* numIndices, three per triangle; read during the call only */
    uint64_t numIndices;     /* a multiple of 3 */
    PelWeld weld; /* welding: vertices at the same place become one vertex of the topology; default none */
    float weldTolerance; /* length; PEL_WELD_TOLERANCE only */
    /* needed when welding: xyz per vertex, positionStride bytes apart; read during the call */
    const float* positions;
    uint32_t positionStride; /* bytes; 0: 12 */
} PelMeshTopologyDesc;

/* Analyses the connectivity once; curvature for any positions then reuses it. Errors:
 * PEL_ERROR_INVALID_ARGUMENT for an index count that is not a multiple of 3 or an index >= numVertices (the
 * message names the triangle). `report` may be NULL. */
PEL_API PelError pelMeshTopologyCreate(PelDevice device, const PelMeshTopologyDesc* desc,
                                       PelMeshTopology* topology, PelMeshReport* report);
PEL_API void pelMeshTopologyRetain(PelMeshTopology topology);
PEL_API void pelMeshTopologyRelease(PelMeshTopology topology);

/* The analysis as bytes, to be stored and loaded without analysing again. `size`: before the call the bytes
 * at `destination` (any value if destination is NULL), after it the bytes of the analysis. For machines of
 * the same byte order and this version of the library; pelMeshTopologyLoad refuses others, and damaged data.
 * Errors: PEL_ERROR_INVALID_ARGUMENT if `destination` is too small. */
PEL_API PelError pelMeshTopologySave(PelMeshTopology topology, void* destination, size_t* size);
PEL_API PelError pelMeshTopologyLoad(PelDevice device, const void* bytes, size_t size,
                                     PelMeshTopology* topology, PelMeshReport* report);

/* The result of pelMeshOrient. A part: triangles connected by edges that belong to two of them. */
typedef struct PelMeshOrientation {
    uint32_t structSize;
    uint32_t trianglesTurned; /* triangles whose second and third index were exchanged */
    uint32_t parts;
    uint32_t partsTurned;       /* with a triangle that was reversed */
    uint32_t inconsistentEdges; /* that remain: of parts with one side only, such as a Moebius strip */
    uint32_t partsByNormals;    /* of partsTurned: the normals decided the side */
    uint32_t partsByVolume;     /* the part is closed, and its inside decided the side */
    uint32_t partsByMajority;   /* the side is a guess: that of most of the triangles */
} PelMeshOrientation;

/* Reverses triangles so that the two triangles of every edge run along it in opposite directions, as those of
 * one surface do. `indices`: desc->numIndices, written: the indices of desc (may be the same array), with the
 * second and third index of some triangles exchanged. Parts that are consistent already are left unchanged,
 * whichever side they face. The outward side of the other parts is the one that `normals` (xyz float32 per
 * vertex, normalStride bytes apart, 0: 12; or NULL) point to. If these do not decide, the part is closed and
 * desc has positions, it is the side away from the inside; otherwise that of most of its triangles.
 * desc->weld decides which vertices are the same. No other function reverses triangles: pelMeshNormals and
 * the estimators use them unchanged. `found` may be NULL. Errors: as pelMeshTopologyCreate. */
PEL_API PelError pelMeshOrient(const PelMeshTopologyDesc* desc, const float* normals, uint32_t normalStride,
                               uint32_t* indices, PelMeshOrientation* found);

/* Vertex data inside a buffer. */
typedef struct PelVertexView {
    PelBuffer buffer;
    uint64_t byteOffset; /* a multiple of 4 */
    uint32_t byteStride; /* a multiple of 4; 0: tightly packed */
    uint32_t count;      /* vertices */
} PelVertexView;

typedef enum PelCurvatureEstimator {
    PEL_CURVATURE_EDGE = 0,   /* (min + max) / 2 of |dn| / |dp| over a vertex's triangle edges [FaceWorks] */
    PEL_CURVATURE_TENSOR = 1, /* least squares on each triangle's normal differences [Rusinkiewicz 2004] */
    /* polynomial fit to the positions of the two-ring: does not depend on the normals. Default */
    PEL_CURVATURE_QUADRIC = 2
} PelCurvatureEstimator;

/* The quantity that is written for a vertex. Curvatures are positive where the surface curves away from its
 * normal (a sphere with outward normals has two positive ones); k1 >= k2. Edge has only the first. */
typedef enum PelCurvatureQuantity {
    /* |k1 + k2| / 2, 1/radius of the best sphere; edge: its own estimate. For LUTs */
    PEL_QUANTITY_ABSOLUTE = 0,
    /* max(|k1|, |k2|), 1/radius of the best cylinder: on a cylinder twice the above */
    PEL_QUANTITY_ABSOLUTE_MAX = 1,
    /* sqrt((k1^2 + k2^2) / 2) [Koenderink 1992]: between the two, 0 on planes only */
    PEL_QUANTITY_CURVEDNESS = 2,
    PEL_QUANTITY_MEAN = 3,      /* H = (k1 + k2) / 2, signed */
    PEL_QUANTITY_GAUSSIAN = 4,  /* K = k1 k2, 1/length^2; `scale` multiplies it twice */
    PEL_QUANTITY_FIRST = 5,     /* k1 */
    PEL_QUANTITY_SECOND = 6,    /* k2 */
    PEL_QUANTITY_PRINCIPAL = 7, /* k1, k2: 2 floats */
    /* k1, k2, unit direction of k1, unit direction of k2: 8 floats. Directions are not smoothed; 0 where
     * nothing was measured */
    PEL_QUANTITY_FRAME = 8
} PelCurvatureQuantity;

/* How a smoothing to a radius weights the neighbours of a vertex. Neither result depends on the density of
 * the mesh. */
typedef enum PelSmoothingWeights {
    /* cotangents over Voronoi areas [Pinkall & Polthier 1993]: spreads equally in all directions, whatever
     * the triangles look like. Default */
    PEL_SMOOTHING_COTANGENT = 0,
    /* only cotangents that are not negative, scaled down so that the radius stays the same: no value leaves
     * the range of its neighbours, and the sum of value times area (a third of the triangles) is kept; less
     * uniform than all cotangents on stretched irregular cells */
    PEL_SMOOTHING_AREA = 1
} PelSmoothingWeights;

typedef struct PelCurvatureParams {
    uint32_t structSize;
    PelCurvatureEstimator estimator;
    /* each vertex becomes the mean of its triangles' other two vertices; typical 2 */
    uint32_t smoothingPasses;
    float scale; /* multiplies the result; 1 when mesh and LUT share their unit of length */
    PelCurvatureQuantity quantity;
    /* length; standard deviation of a smoothing that does not depend on the mesh's density; 0: none. Unless
     * smoothingStages is given, calls without a PelSubmit measure the mesh. Calls with one take the
     * topology's last measurement, made at a pose of about the same size; if there is none they block */
    float smoothingRadius;
    /* with a radius: angle between normals, radians, across which smoothing falls to 1/e, so that sharp
     * features are kept; 0: no such limit */
    float smoothingCrease;
    /* with a radius: number of stages, about 9 * radius / edge length; too few smooth less. 0: chosen from
     * the mesh; short waves are then corrected for the density of the mesh, which a given number does not do
     * (docs/guide/curvature.md) */
    uint32_t smoothingStages;
    PelSmoothingWeights smoothingWeights; /* with a radius */
} PelCurvatureParams;

/* Curvature at each vertex. `positions`, `normals`: xyz float32 per vertex, as many as the topology has;
 * normals are of unit length; NULL: they are made from the positions, as by pelMeshNormals. `curvature`: one
 * float32 per vertex (more for some quantities), 1/length, finite; 0 where nothing could be measured. Signed
 * values are smoothed, then the quantity is taken. The call blocks with a `report`, the first time that a
 * topology lists its two-rings for PEL_CURVATURE_QUADRIC, and the first time with a smoothingRadius. Same
 * input, same bits. Sources: FaceWorks 1.0; Rusinkiewicz, Estimating Curvatures, 3DPVT 2004. */
PEL_API PelError pelMeshCurvature(PelMeshTopology topology, const PelCurvatureParams* params,
                                  const PelVertexView* positions, const PelVertexView* normals,
                                  const PelVertexView* curvature, PelMeshReport* report,
                                  const PelSubmit* submit);

/* Unit normals from positions: the mean of the normals of a vertex's triangles, weighted by their angles
 * there; a welded vertex has one. (0, 0, 0) where all triangles are degenerate. `normals`: xyz float32 per
 * vertex, written. Same input, same bits. Source: Thuermer & Wuethrich 1998. */
PEL_API PelError pelMeshNormals(PelMeshTopology topology, const PelVertexView* positions,
                                const PelVertexView* normals, const PelSubmit* submit);

/* Geometric mean over triangles of longest edge / longest UV edge, in length per UV unit. `uvs`: two float32
 * per vertex. Triangles where either edge is below 1e-6 of the mesh's largest are skipped. Blocks. Errors:
 * PEL_ERROR_INVALID_ARGUMENT when no triangle is left. */
PEL_API PelError pelMeshUvScale(PelMeshTopology topology, const PelVertexView* positions,
                                const PelVertexView* uvs, float* uvScale);

/* ---- Meshes that move --------------------- */

typedef struct PelLiveMeshObject* PelLiveMesh;

/* `count` vertices from `first` on. */
typedef struct PelVertexRange {
    uint32_t first;
    uint32_t count;
} PelVertexRange;

/* Curvature, by `params`, of a mesh that moves in part between updates. The device keeps between updates, per
 * vertex: 4 to 32 bytes of estimates, 8 to 16 of smoothed values, 12 of normals if it makes them. */
PEL_API PelError pelLiveMeshCreate(PelMeshTopology topology, const PelCurvatureParams* params,
                                   PelLiveMesh* live);
PEL_API void pelLiveMeshRetain(PelLiveMesh live);
PEL_API void pelLiveMeshRelease(PelLiveMesh live);

/* Gives the same bits as pelMeshCurvature, with only the work that the change needs. A smoothing to a radius
 * is measured, as there, by updates of all vertices alone. `changed`: numChanged
 * ranges of vertices whose position or normal differs from the previous update, in any order; NULL: all. Only
 * rows that they reach are measured, smoothed and written; empty ranges cost no launch and no byte. The first
 * update measures everything, as does one that begins or stops to give normals. An update with another
 * `curvature` writes all of it. One asynchronous submission. These block: the first with a smoothing radius,
 * which measures the mesh, unless params.smoothingStages is given; a topology's first with
 * PEL_CURVATURE_QUADRIC; and the first with `changed`, which reads the neighbour lists back. Errors:
 * PEL_ERROR_INVALID_ARGUMENT for a range that leaves the mesh. */
PEL_API PelError pelLiveMeshUpdate(PelLiveMesh live, const PelVertexView* positions,
                                   const PelVertexView* normals, const PelVertexView* curvature,
                                   const PelVertexRange* changed, uint32_t numChanged,
                                   const PelSubmit* submit);

/* Statistics of the last update. A row is a vertex after welding; rows are worked on eight at a time. */
typedef struct PelLiveMeshStats {
    uint32_t structSize;
    uint32_t rowsTotal;
    uint64_t launches;
    uint64_t rowsEstimated;
    uint64_t rowsSmoothed;  /* summed over passes */
    uint64_t rowsStored;    /* exactly the rows that the change reaches */
    uint64_t bytesUploaded; /* lists of rows; 0 when the same vertices change again */
    uint64_t deviceBytes;   /* held between updates */
    uint64_t hostBytes;     /* neighbour lists on the host, once `changed` was given; about 32 per vertex */
} PelLiveMeshStats;
PEL_API PelError pelLiveMeshGetStats(PelLiveMesh live, PelLiveMeshStats* stats);

/* ---- Curvature from a G-buffer --------------------- */

typedef struct PelScreenCurvatureParams {
    uint32_t structSize;
    float scale; /* multiplies the result; 1 when the picture and the LUT share their unit of length */
    /* 0 to 1: sine of the angle between the surface and the step to the next pixel from which the step
     * crosses an edge of depth; 0.5 */
    float edge;
    float inverseViewProjection[16]; /* clip to world, for depth, as in PelCamera */
} PelScreenCurvatureParams;

/* Curvature per pixel for hosts without per-vertex data: |fwidth N| / |fwidth P|, whose differences never
 * cross an edge of depth or between ids. A sphere has 1/radius; a cylinder a value between 0 and 1/radius
 * that depends on its angle to the pixel grid. `normals`: unit, world; `positions`: world; or `depth` with
 * params.inverseViewProjection and positions NULL; `ids`: of materials or objects, 0 is background; may be
 * NULL. `curvature`: R32F, written, finite; 0 for background and for pixels whose normal or position is not
 * finite, which neighbours ignore. All images have one size. `params` may be NULL. Source: Penner, SIGGRAPH
 * 2011. */
PEL_API PelError pelScreenCurvature(PelDevice device, const PelScreenCurvatureParams* params,
                                    const PelImageDesc* normals, const PelImageDesc* positions,
                                    const PelImageDesc* depth, const PelImageDesc* ids,
                                    const PelImageDesc* curvature, const PelSubmit* submit);

/* ---- Diffusion profiles --------------------- */

typedef struct PelProfileObject* PelProfile;

typedef enum PelProfileKind {
    PEL_PROFILE_SKIN = 0,
    PEL_PROFILE_GAUSSIANS = 1,
    PEL_PROFILE_BURLEY = 2,
    PEL_PROFILE_DIPOLE = 3,
    PEL_PROFILE_TABLE = 4,
    PEL_PROFILE_SKIN_LAYERS = 5
} PelProfileKind;

/* weight * exp(-d^2 / 2 variance) / (2 pi variance): energy per area at distance d. The line spread has the
 * same variance and weight. */
typedef struct PelGaussian {
    float variance;  /* length^2, > 0; mm^2 */
    float weight[3]; /* red, green, blue, >= 0; scaled so that each channel sums to 1 */
} PelGaussian;

/* The fits of s(A) in Christensen and Burley 2015. They differ in the meaning of the length and in how light
 * enters. */
typedef enum PelBurleyFit {
    PEL_BURLEY_SEARCHLIGHT = 0, /* eq. 5: volume mean free path, perpendicular beam */
    /* eq. 6: volume mean free path, diffuse transmission; the usual one */
    PEL_BURLEY_DIFFUSE_TRANSMISSION = 1,
    /* eq. 8: diffuse mean free path on the surface, perpendicular beam */
    PEL_BURLEY_DIFFUSE_MEAN_FREE_PATH = 2
} PelBurleyFit;

/* A profile says, per RGB channel, how much of the light that enters at one point leaves at a distance. It
 * belongs to no device and never changes. Lengths are in any one unit, mm for skin. All are normalised: no
 * light is lost. Errors: PEL_ERROR_INVALID_ARGUMENT for values that are not finite or out of the ranges
 * below, or a channel without energy; the message names the value. */

/* Six Gaussians [d'Eon and Luebke, GPU Gems 3, ch. 14; FaceWorks 1.0], in mm; radius 2.7 mm. */
PEL_API PelError pelProfileCreateSkin(PelProfile* profile);
/* `count` (1 to 256) Gaussians in any order. Radius: sigma of the widest that has a weight. */
PEL_API PelError pelProfileCreateGaussians(const PelGaussian* gaussians, uint32_t count, PelProfile* profile);
/* R(d) = (exp(-d/b) + exp(-d/3b)) / (8 pi b d), b = meanFreePath / s(albedo), per channel. meanFreePath > 0,
 * length; albedo in [0, 1]. Radius, here and for the next two: root mean square width of the widest channel's
 * line spread. Source: Christensen and Burley, Approximate Reflectance Profiles for Efficient Subsurface
 * Scattering, 2015. */
PEL_API PelError pelProfileCreateBurley(const float meanFreePath[3], const float albedo[3], PelBurleyFit fit,
                                        PelProfile* profile);
/* The same from b itself, length > 0. Other programs call it d (Blender's radius is 4 pi d). */
PEL_API PelError pelProfileCreateBurleyDistance(const float distance[3], PelProfile* profile);
/* The classical dipole. absorption and reducedScattering > 0, 1/length; eta > 1, the medium's index of
 * refraction relative to its outside. Source: Jensen, Marschner, Levoy, Hanrahan, A Practical Model for
 * Subsurface Light Transport, 2001. */
PEL_API PelError pelProfileCreateDipole(const float absorption[3], const float reducedScattering[3],
                                        float eta, PelProfile* profile);
/* A tabulated profile: R linear between `count` (2 to 4096) rising distances >= 0, constant before the first,
 * 0 after the last. `values`: RGB per distance, >= 0, up to a factor. Look-up tables are integrated from it
 * exactly, including its corners. */
PEL_API PelError pelProfileCreateTable(const float* distances, const float* values, uint32_t count,
                                       PelProfile* profile);
/* The composition of human skin: an epidermis over an infinitely thick dermis, both of refractive index 1.4.
 * Ranges and defaults: docs/guide/skin.md; formulas and sources: docs/mathematics.md, section 15. */
typedef struct PelSkin {
    uint32_t structSize;
    float melanin;         /* share of the epidermis' volume that is melanosomes */
    float eumelanin;       /* share of the melanin that is eumelanin, the rest is pheomelanin */
    float blood;           /* share of the dermis' volume that is blood */
    float oxygenation;     /* share of the haemoglobin that carries oxygen */
    float epidermis;       /* mm, its thickness */
    float scattering;      /* 1/mm, the reduced scattering coefficient at 500 nm */
    float scatteringPower; /* b of its factor (wavelength / 500 nm)^-b */
    float water;           /* share of the dermis' volume */
    float carotene;        /* mg per litre of epidermis */
    float bilirubin;       /* mg per litre of dermis */
} PelSkin;

/* Optical properties that follow from a PelSkin, per channel of linear sRGB under D65. */
typedef struct PelSkinInfo {
    uint32_t structSize;
    float albedo[3];                 /* of diffuse light, without surface reflection; 0 to 1 */
    float meanFreePath[3];           /* mm, in the dermis, weighted by the light that leaves */
    float singleScatteringAlbedo[3]; /* of the dermis, weighted alike */
    float meanDistance[3];           /* mm, between where light enters and leaves */
    /* greatest difference between the profile's sum of Gaussians and the computed one, as a share of the
     * channel's light, over all frequencies */
    float profileError[3];
    float lab[3];        /* CIE L*a*b* of the albedo, D65 */
    float typologyAngle; /* degrees, ITA = atan((L* - 50) / b*) */
} PelSkinInfo;

/* Albedo and lengths of skin. `skin` may be NULL in all these: the defaults. Errors:
 * PEL_ERROR_INVALID_ARGUMENT for a field out of range, by name. The first call of a process takes some tenths
 * of a second, later ones 0.2 ms. */
PEL_API PelError pelSkinGetInfo(const PelSkin* skin, PelSkinInfo* info);
/* Diffuse reflectance of skin at `count` wavelengths, 380 to 720 nm, without surface reflection. */
PEL_API PelError pelSkinReflectance(const PelSkin* skin, const float* nanometres, uint32_t count,
                                    float* reflectance);
/* A profile in mm: up to 14 Gaussians. Radius: as for Burley's. */
PEL_API PelError pelProfileCreateSkinLayers(const PelSkin* skin, PelProfile* profile);
/* Maps: for `count` values of melanin and blood, with the other fields of `skin`, RGB albedos (3 * count) and
 * lengths relative to the profile of `skin` (count), for the second component of PEL_SLOT_SCATTER_WEIGHT;
 * either may be NULL. NaN counts as the value of `skin`; others are clamped. PEL_SLOT_SKIN takes the maps
 * themselves. */
PEL_API PelError pelSkinAlbedo(const PelSkin* skin, const float* melanin, const float* blood, uint64_t count,
                               float* albedo, float* radius);
/* The inverse: for `count` linear RGB albedos the melanin and blood whose albedo is nearest by CIEDE2000, and
 * that distance (NULL: not wanted). A difference above about 1 is visible: no skin of this model has that
 * colour. NaN counts as 0. */
PEL_API PelError pelSkinFromAlbedo(const PelSkin* skin, const float* albedo, uint64_t count, float* melanin,
                                   float* blood, float* difference);
/* A material of the library, in mm: "skin", "marble", ... Errors: PEL_ERROR_INVALID_ARGUMENT for an unknown
 * name; the message lists the known ones. */
PEL_API PelError pelProfileCreateNamed(const char* name, PelProfile* profile);
/* Name of the library's material `index`, from 0 on; NULL after the last. Static storage. */
PEL_API const char* pelProfileLibraryName(uint32_t index);
PEL_API void pelProfileRetain(PelProfile profile);
PEL_API void pelProfileRelease(PelProfile profile);

typedef struct PelProfileInfo {
    uint32_t structSize;
    PelProfileKind kind;
    /* length that diffusionRadius refers to: a table for radius rho stretches the profile by rho/radius */
    float radius;
    float width[3]; /* length, standard deviation of the line spread per channel */
    /* for PelMaterial.normalBlend: 1 - log8(widest width / width), at least 0. The widest channel uses only
     * the blurred normal, a channel eight times narrower only the shading normal; 1, 0.28, 0.03 for skin */
    float normalBlend[3];
    uint32_t gaussians; /* terms of the sum that represents it on the device; 0 for tabulated profiles */
    /* 1: R grows like 1/d towards 0, so that the ring forms have no finite integral (burley) */
    uint32_t singular;
    char name[64]; /* for tables and their files; the kind's name unless pelProfileSetName was called */
    /* length; known for burley from mean free paths and for dipole, 0 for all others */
    float meanFreePath[3];
    float reach;      /* length within which all but a thousandth of the light of each channel leaves */
    char source[256]; /* of the numbers of a material of the library; "" for others */
} PelProfileInfo;
PEL_API PelError pelProfileGetInfo(PelProfile profile, PelProfileInfo* info);
/* Names a profile, once, before it is used: up to 63 bytes. */
PEL_API PelError pelProfileSetName(PelProfile profile, const char* name);

/* Transmission of a slab that is lit evenly on its far side: the share of R beyond `count` distances >= 0
 * (length), RGB each. (1/4) exp(-s/b) + (3/4) exp(-s/3b) for Burley's profile, the sum of w exp(-s^2/2v) for
 * Gaussians [Jimenez et al. 2010]. */
PEL_API PelError pelProfileTransmission(PelProfile profile, const double* distances, uint32_t count,
                                        double* transmission);
/* R and P at `count` distances > 0 (length): RGB each, either may be NULL. R is energy per area, P energy per
 * length. */
PEL_API PelError pelProfileEvaluate(PelProfile profile, const double* distances, uint32_t count,
                                    double* radial, double* lineSpread);

/* ---- Look-up tables --------------------- */

typedef struct PelLutObject* PelLut;

typedef enum PelLutKind {
    PEL_LUT_CURVATURE = 0,
    PEL_LUT_SHADOW = 1,
    PEL_LUT_SPECULAR = 2,
    PEL_LUT_EYE = 3 /* light on the iris: the caustic of a cornea */
} PelLutKind;

/* The geometry over which a curvature LUT is integrated; docs/guide/luts.md says how to choose. */
typedef enum PelCurvatureForm {
    PEL_FORM_ARC = 0, /* the line spread along the arc of a circle, cut at 10 mm * radius / 2.7 [FaceWorks] */
    PEL_FORM_RING = 1, /* the radial profile R (energy per area) of the chord, round a circle, normalised */
    PEL_FORM_HALF_RING = 2, /* the same over the half circle about the point */
    /* the radial profile of the chord, over a whole sphere, normalised: exact for a sphere */
    PEL_FORM_SPHERE = 3,
    /* the line spread P (energy per length) of the chord, round a circle, normalised: the published table
     * [Penner 2011], and a cylinder by straight-line distances */
    PEL_FORM_PENNER_RING = 4
} PelCurvatureForm;

/* How texels are spread over the axes of a curvature LUT. Look-ups in pellucid follow the table's own axis; a
 * host that reads a table itself must do so too. s is the texel coordinate from -1 to 1 across, t that from 0
 * to 1 down. */
typedef enum PelLutAxis {
    PEL_AXIS_LINEAR = 0, /* u = s; curvature linear in t [FaceWorks] */
    /* square-root axis: u = s |s|; the square root of curvature linear in t: dense at the terminator and
     * for flat surfaces, so that look-ups in 64x64 texels are as good as in 1024x1024 linear ones */
    PEL_AXIS_ROOT = 1
} PelLutAxis;

/* pelCurvatureLutDescDefaults() is the table that a material makes of its profile,
 * pelCurvatureLutDescFaceWorks() that of FaceWorks. */
typedef struct PelCurvatureLutDesc {
    uint32_t structSize;
    uint32_t width;        /* texels along N.L from -1 to 1; 1 to 16384, at most 2^26 in all; default 64 */
    uint32_t height;       /* texels along curvature from 1/radiusMax to 1/radiusMin; default 64 */
    PelCurvatureForm form; /* default PEL_FORM_SPHERE */
    /* length; stretches the profile, whose own radius is in PelProfileInfo; default 0: its own */
    float diffusionRadius;
    float radiusMin; /* length, smallest radius of curvature; default 0: a quarter of the diffusion radius */
    float radiusMax; /* length; default 0: 1000 diffusion radii */
    PelLutAxis axis; /* default PEL_AXIS_ROOT */
    PelProfile profile; /* NULL: skin. The table keeps it alive */
} PelCurvatureLutDesc;

/* pelShadowLutDescDefaults() is the table that a material makes of its profile, pelShadowLutDescFaceWorks()
 * that of FaceWorks. */
typedef struct PelShadowLutDesc {
    uint32_t structSize;
    /* texels along the wide-filtered shadow from 0 to 1; 1 to 16384, at most 2^26 in all; default 128 */
    uint32_t width;
    uint32_t height;       /* texels along 1/penumbra width, from widest to narrowest; default 32 */
    float diffusionRadius; /* length; default 0: the profile's own radius */
    /* length, narrowest penumbra; default 0: the width of a material's shadow filter,
     * pelShadowFilterWidthOf() */
    float widthMin;
    float widthMax;     /* length; default 0: 1000 times widthMin */
    float sharpening;   /* >= 1: how much narrower the shadow gets than the wide filter; default 10 */
    PelProfile profile; /* NULL: skin. The table keeps it alive */
    /* 1, the default: each row is rescaled, so that w = 0 gives 0 and w = 1 gives 1: lit skin then keeps the
     * light that scatters further than the filter reaches; 0: not rescaled [FaceWorks] */
    uint32_t closedEnds;
    /* PEL_AXIS_LINEAR: w and 1/width linear [FaceWorks]; PEL_AXIS_ROOT, the default: the position across the
     * edge, (sqrt(w) - sqrt(1 - w)) / 2 + 1/2, and the root of 1/width linear, from end to end */
    PelLutAxis axis;
} PelShadowLutDesc;

typedef struct PelSpecularLutDesc {
    uint32_t structSize;
    uint32_t width;  /* texels along n.h from 0 to 1; 1 to 16384, at most 2^26 in all; typical 512 */
    uint32_t height; /* texels along the roughness m from 0 to 1; typical 512 */
} PelSpecularLutDesc;

/* The caustic of a cornea: irradiance on the iris under a beam with an irradiance of 1 across its direction.
 * Lengths are in any one unit: the table does not depend on the size of the eye. Descriptions that would take
 * more than a few seconds are refused. Fields of PelEye: see there. */
typedef struct PelEyeLutDesc {
    uint32_t structSize;
    /* texels across the iris along the light, from the far rim to the near one; 2 to 1024; 64 */
    uint32_t width;
    /* texels from the line through the light's direction to the rim: the other half is its mirror image; 2 to
     * 1024; 64 */
    uint32_t height;
    /* slices over the light's angle to the gaze, the first at 0 and the last where no light enters any
     * longer; 2 to 256; 32 */
    uint32_t depth;
    float scleraRadius;
    float corneaRadius;
    float corneaConic;
    float limbusRadius;
    float chamberDepth;
    float corneaIndex;
    float aqueousIndex;
    float irisRadius;
    float irisConcavity;
    float millimetresPerUnit; /* units of the profile per unit of the lengths above; 1 */
    /* of the iris, whose light is scattered in the table; NULL: not scattered. The table keeps it alive */
    PelProfile profile;
} PelEyeLutDesc;

/* Integrates a curvature LUT: texel (x, y) holds D(N.L, r) per channel, row 0 the smallest curvature.
 * Sources: FaceWorks 1.0; Penner, SIGGRAPH 2011. */
PEL_API PelError pelCurvatureLutCreate(PelDevice device, const PelCurvatureLutDesc* desc, PelLut* lut,
                                       const PelSubmit* submit);
/* Integrates a shadow LUT: texel (x, y) holds the light transmitted per channel, row 0 the widest
 * penumbra. Source: FaceWorks 1.0. */
PEL_API PelError pelShadowLutCreate(PelDevice device, const PelShadowLutDesc* desc, PelLut* lut,
                                    const PelSubmit* submit);
/* Tabulates Beckmann's distribution P(n.h, m) as P^0.1 / 2, the same in all channels, row 0 the smallest m.
 * Source: d'Eon and Luebke, GPU Gems 3, ch. 14. */
PEL_API PelError pelSpecularLutCreate(PelDevice device, const PelSpecularLutDesc* desc, PelLut* lut,
                                      const PelSubmit* submit);
/* Integrates the caustic of a cornea by carrying the wavefront of each slice's light through it, with
 * Fresnel's transmittance and light that its inside reflects: no flux is lost between texels. Texels in rows
 * as one image, width x (height * depth), slice below slice: light along the gaze first. Texel (x, y) of
 * slice z: the mean irradiance of its area on the iris, whose rim is the circle that touches the sides of the
 * image. Same input, same bits. Source: docs/mathematics.md, section 13. */
PEL_API PelError pelEyeLutCreate(PelDevice device, const PelEyeLutDesc* desc, PelLut* lut,
                                 const PelSubmit* submit);
PEL_API void pelLutRetain(PelLut lut);
PEL_API void pelLutRelease(PelLut lut);

/* Its defaults describe FaceWorks' tables, since most texels that hosts bring are of these. */
typedef struct PelLutInfo {
    uint32_t structSize;
    PelLutKind kind;
    PelCurvatureLutDesc curvature; /* of a PEL_LUT_CURVATURE */
    PelShadowLutDesc shadow;       /* of a PEL_LUT_SHADOW */
    PelSpecularLutDesc specular;   /* of a PEL_LUT_SPECULAR */
    char profile[64];              /* name of the profile, also for tables from texels; "skin" by default */
    PelEyeLutDesc eye;             /* of a PEL_LUT_EYE */
} PelLutInfo;
/* The description with all defaults resolved; a profile in it is the handle that the caller gave. */
PEL_API PelError pelLutGetInfo(PelLut lut, PelLutInfo* info);

typedef enum PelLutEncoding {
    PEL_LUT_FLOAT = 0, /* RGB float32, the values themselves */
    PEL_LUT_HALF = 1,  /* RGB float16, the same */
    /* RGBA8: curvature sat(2 (D - max(u, 0)) + 1/2); shadow faded at the left edge, then sRGB; specular
     * unchanged */
    PEL_LUT_FACEWORKS8 = 2
} PelLutEncoding;

/* Bytes that pelLutRead writes: width * height * 12, 6 or 4; of a PEL_LUT_EYE times its depth, and not
 * PEL_LUT_FACEWORKS8. */
PEL_API PelError pelLutGetSize(PelLut lut, PelLutEncoding encoding, size_t* bytes);
/* The texels, row-major, top row first. `destination` holds `bytes` >= pelLutGetSize. */
PEL_API PelError pelLutRead(PelLut lut, PelLutEncoding encoding, void* destination, size_t bytes,
                            const PelSubmit* submit);
/* Makes `count` tables and reads them, one below the other, each with the same bits as pelLutRead gives:
 * several times as fast for many small tables as one by one. All are of one kind, PEL_LUT_CURVATURE or
 * PEL_LUT_SHADOW, and of one size, axis and form or closedEnds. `destination` holds `bytes` >= count times
 * width * height * 12, 6 or 4. Waits. All structures have the structSize of the first. */
PEL_API PelError pelLutReadStack(PelDevice device, const PelLutInfo* tables, uint32_t count,
                                 PelLutEncoding encoding, void* destination, size_t bytes);
/* Texels of a curvature LUT whose residual D - max(u, 0) lies beyond +-1/4 in some channel:
 * PEL_LUT_FACEWORKS8 clips them. 0 for other kinds. Waits for the LUT. */
PEL_API PelError pelLutCountClipped(PelLut lut, uint64_t* clipped);
/* A LUT from texels that were integrated before: RGB float32, width * height * 12 bytes, described by info.
 */
PEL_API PelError pelLutCreateFromTexels(PelDevice device, const PelLutInfo* info, const float* texels,
                                        size_t bytes, PelLut* lut);

/* ---- Shading --------------------- */

typedef struct PelShaderObject* PelShader;

/* The images of a G-buffer. The feature of a slot that is not set is off. All set images have one size. */
typedef enum PelImageSlot {
    PEL_SLOT_RADIANCE = 0, /* output, RGB or RGBA, float or half: the shaded pixels. Needed */
    PEL_SLOT_MATERIAL = 1, /* id per pixel, uint or float; 0 is background. Not set: all are material 1 */
    PEL_SLOT_POSITION = 2, /* xyz, world. Needed by thickness, specular and positional lights */
    PEL_SLOT_DEPTH = 3,    /* device depth, with PelCamera.inverseViewProjection, instead of positions */
    PEL_SLOT_NORMAL_GEOMETRIC = 4,  /* Ng, unit. Not set: the shading normal */
    PEL_SLOT_NORMAL_SHADING = 5,    /* N, unit. Needed */
    PEL_SLOT_NORMAL_BLURRED = 6,    /* Nb, unit. Not set: the geometric normal */
    PEL_SLOT_CURVATURE = 7,         /* 1/length. With a curvature LUT: direct scattering */
    PEL_SLOT_ALBEDO = 8,            /* RGB. Not set: PelMaterial.albedo */
    PEL_SLOT_AMBIENT_OCCLUSION = 9, /* 0 to 1, multiplies the ambient term */
    /* length along the inward normal, instead of shadow map taps. The shader's own irradiance is reduced by
     * the light that leaves a thin body on its far side, if the profile's mean free path is known; 0 or less,
     * NaN: unknown */
    PEL_SLOT_THICKNESS = 10,
    PEL_SLOT_ROUGHNESS = 11, /* multiplies PelMaterial.roughness */
    PEL_SLOT_SPECULAR = 12,  /* multiplies PelMaterial.specular */
    PEL_SLOT_UV = 13, /* u, v of the normal map: two components, float or half. Needed by normal maps */
    /* du/dx, dv/dx, du/dy, dv/dy per pixel: four components. Not set: only the diffusion radius chooses the
     * level of a normal map */
    PEL_SLOT_UV_GRADIENT = 14,
    /* xyz, unit, along u; a fourth component below 0 reverses the bitangent. Needed by normal maps */
    PEL_SLOT_TANGENT = 15,
    /* Outputs beside radiance, which they do not change: parts of it per pixel of a material, for compositing
     * and debugging. Always replaced, never added to; RGB or RGBA, float or half, except the last. */
    PEL_SLOT_OUT_DIFFUSE = 16,      /* albedo * (scattered light + ambient) */
    PEL_SLOT_OUT_DEEP_SCATTER = 17, /* albedo * light that came through */
    PEL_SLOT_OUT_SPECULAR = 18,
    /* length, one component: the thickness image; without one, along the first light with a shadow map, of
     * materials with thicknessTaps and a deepScatterColor or, by tables, transmission; else 0 */
    PEL_SLOT_OUT_THICKNESS = 19,
    /* RGB, irradiance / pi: all lights and the ambient, shadows sharp; no specular, no albedo. Read by
     * materials that do not scatter by tables (PelMaterial.scattering); not set: made from lights,
     * PEL_LIGHT_WIDE_SHADOW or shadow maps, and the ambient */
    PEL_SLOT_IRRADIANCE = 20,
    /* one or two components. First, 0 to 1: the share of scattered light in a pixel, the rest is its own
     * irradiance; 0: no scattering. Second, 0 to 4: factor of the profile's radius. Both are clamped; NaN is
     * 0. Not set: 1 */
    PEL_SLOT_SCATTER_WEIGHT = 21,
    /* RGB, as PEL_SLOT_IRRADIANCE: of the other side of a thin sheet (PelMaterial.thinThickness). Not set:
     * made from lights and ambient */
    PEL_SLOT_IRRADIANCE_BACK = 22,
    /* 0 to 1, one component: the wet line along the lids, where tears collect. Read by eyes: the roughness of
     * their gloss there is PelEye.wetLineRoughness. Clamped; NaN is 0. Not set: 0 */
    PEL_SLOT_WETNESS = 23,
    /* H, the mean of both principal curvatures, 1/unit of positions, one component: positive where the
     * surface is convex, negative in hollows. Read by PelMaterial.curvatureGain. Not set: measured from
     * positions or depth, and from normals */
    PEL_SLOT_MEAN_CURVATURE = 24,
    /* two or three components: PelSkin.melanin, PelSkin.blood, PelSkin.oxygenation. Read by materials whose
     * profile is of pelProfileCreateSkinLayers, which gives the other fields: albedo and radius are computed
     * from this image, and the albedo image is not read. Clamped to the ranges; NaN and missing components:
     * the profile's value */
    PEL_SLOT_SKIN = 25,
    /* two or three components, float or half: the position of a pixel's surface in the last frame minus that
     * in this frame, in pixels to the right and down; and, for surfaces whose distance changes, how much
     * farther from the camera it was (length; in parallel views along rising depth). Read with
     * PelShaderOptions.historyWeight. NaN, Inf: the pixel takes nothing from the last frame. Not set: 0 */
    PEL_SLOT_MOTION = 26,
    /* RGB, irradiance / pi: light in addition to the lights and PelAmbient, such as light that bounced off
     * other surfaces, or an engine's probes. No albedo; added to the ambient term after its occlusion, and
     * scatters with it. If PEL_SLOT_IRRADIANCE is set, it must include this light for the materials that read
     * it. Not set: 0 */
    PEL_SLOT_INDIRECT = 27,
    PEL_SLOT_COUNT = 28
} PelImageSlot;

/* The images of one light. */
typedef enum PelLightSlot {
    /* w per pixel, 0 shadow to 1 lit, filtered over PelMaterial.shadowFilterWidth. Not set:
     * PelLight.shadowFilterTexels makes it from the shadow map */
    PEL_LIGHT_WIDE_SHADOW = 0,
    /* depth in [0, 1], any size, one component: thickness by taps, wide shadow. Other forms:
     * PelLight.shadowProjection, shadowContent, shadowCascades */
    PEL_LIGHT_SHADOW_MAP = 1,
    /* the second of PelLight.shadowCascades, and so on. Maps that share one image (an atlas) are views of
     * it: the same buffer and rowStride, each with its byteOffset */
    PEL_LIGHT_CASCADE_1 = 2,
    PEL_LIGHT_CASCADE_2 = 3,
    PEL_LIGHT_CASCADE_3 = 4,
    PEL_LIGHT_SLOT_COUNT = 5
} PelLightSlot;

typedef enum PelLightType {
    PEL_LIGHT_DIRECTIONAL = 0,
    PEL_LIGHT_POINT = 1,
    PEL_LIGHT_SPOT = 2,
    PEL_LIGHT_SPHERE = 3,
    PEL_LIGHT_RECTANGLE = 4 /* shines from one side, along halfWidth x halfHeight */
} PelLightType;

/* The cubes are of lights with a position: one image of six square faces, one below the other, +x -x +y -y +z
 * -z, each laid out as in OpenGL, Vulkan and Direct3D, row 0 first. PelLight.worldToShadow then maps world to
 * the cube's own space: a rotation, with the light at the origin. Taps and filters cross the edges of faces
 * (docs/guide/shading.md). */
typedef enum PelShadowProjection {
    PEL_SHADOW_PARALLEL = 0,
    PEL_SHADOW_PERSPECTIVE = 1,
    PEL_SHADOW_CUBE = 2, /* distance along the axis of the face = 1 / (shadowDepthA * z + shadowDepthB) */
    PEL_SHADOW_CUBE_RADIAL = 3 /* distance from the light = shadowDepthRange * z */
} PelShadowProjection;

/* What the texels of a shadow map hold: z, or values that may be filtered beforehand. It is the same for all
 * lights. */
typedef enum PelShadowContent {
    PEL_SHADOW_CONTENT_DEPTH = 0, /* z */
    /* means of z and z^2, two components: variance shadow maps [Donnelly, Lauritzen 2006] */
    PEL_SHADOW_CONTENT_MOMENTS = 1,
    /* mean of exp(shadowExponent * z): exponential shadow maps [Annen et al. 2008] */
    PEL_SHADOW_CONTENT_EXPONENTIAL = 2
} PelShadowContent;

typedef struct PelLight {
    uint32_t structSize;
    PelLightType type;
    float toLight[3];       /* directional: unit vector from the surface to the light */
    float position[3];      /* all but directional: world; of a sphere or rectangle the centre */
    float spotDirection[3]; /* spot: unit vector in the direction of the light's axis */
    float spotCosInner;     /* cosine of the angle from spotDirection up to which the spot is fully bright */
    float spotCosOuter;     /* and from which it is dark; between them a smoothstep of the cosine */
    /* directional: irradiance / pi at normal incidence; point, spot: that at distance 1; sphere, rectangle:
     * that at distance 1 of a point as bright, along the rectangle's axis: radiance * radius^2, radiance *
     * area / pi */
    float color[3];
    float range; /* all but directional: no light beyond it; 0: no limit */
    /* The rest describes the shadow map, if PEL_LIGHT_SHADOW_MAP is set. */
    /* to homogeneous (u, v, z): u, v in [0, 1] over the map, row 0 at v = 0; z as in the map */
    float worldToShadow[16];
    PelShadowProjection shadowProjection;
    /* parallel: length that z from 0 to 1 spans; negative if z decreases away from the light */
    float shadowDepthRange;
    /* perspective: distance along the light = 1 / (A * z + B), from its projection matrix */
    float shadowDepthA;
    float shadowDepthB;
    /* The wide shadow made from the shadow map, when PEL_LIGHT_WIDE_SHADOW is not set (docs/guide/shading.md,
     * "Wide shadow"). */
    /* maximum number of texels across the filter, 4 to 256; of a finer map every 2nd, 3rd, ... row and column
     * is read. 0: materials of PEL_SCATTERING_PREINTEGRATED get no shadow from the map; 48 */
    uint32_t shadowFilterTexels;
    /* The next three are -1 by default: from each material's profile (docs/guide/shading.md, "Materials");
     * without one 0.5 mm, 0.25 and 0.5. */
    float shadowBias; /* length an occluder must stand before the surface to count */
    /* times PelMaterial.shadowFilterWidth: the distance beyond the bias over which an occluder fades in, so
     * that round bodies do not shade themselves with a hard edge */
    float shadowSoftness;
    /* the bias grows by this times the sideways distance, so that folds and facets do not shade themselves */
    float shadowConeSlope;
    /* Cascades: up to four parallel maps of a directional light, the finest first: PEL_LIGHT_SHADOW_MAP with
     * the matrix and range above, then PEL_LIGHT_CASCADE_1, 2, 3 with those below. A point takes the finest
     * map that holds it with its whole filter; outside all maps there is neither shadow nor thickness. */
    uint32_t shadowCascades;      /* 1 to 4 maps; 0: one map that is not a cascade */
    float cascadeToShadow[3][16]; /* worldToShadow of PEL_LIGHT_CASCADE_1, 2, 3 */
    float cascadeDepthRange[3];   /* shadowDepthRange of those */
    PelShadowContent shadowContent;
    /* PEL_SHADOW_CONTENT_EXPONENTIAL: c, with the sign with which c * z grows away from the light; 80 for
     * float32, 10 for half */
    float shadowExponent;
    /* PEL_SHADOW_CONTENT_MOMENTS: length, least standard deviation of depths; 0.25 mm */
    float shadowMinDeviation;
    /* PEL_SHADOW_CONTENT_MOMENTS: 0 to below 1, share of light that counts as none, against light that leaks
     * through overlapping shadows; 0.1 */
    float shadowBleeding;
    float radius; /* sphere: length; 0: a point */
    /* rectangle: from the centre to the middle of a side, and of the next one, at right angles; lengths */
    float halfWidth[3];
    float halfHeight[3];
    /* 0: the light's maps may change from frame to frame. Else a number that the caller changes when the maps
     * change: data computed only from maps is kept until then, and shared by the shaders of a device */
    uint32_t shadowMapVersion;
    /* 1: PEL_LIGHT_WIDE_SHADOW is the visible share of the light, sharp or softened by the light's own size
     * (ray traced, or a renderer's shadow mask), not filtered for tables; PEL_SCATTERING_AUTO then scatters
     * on the screen with it, even if there is a shadow map. 0: it is filtered, or not set */
    uint32_t plainShadow;
} PelLight;

typedef enum PelSpecularModel {
    PEL_SPECULAR_KSK = 0, /* Kelemen and Szirmay-Kalos with Beckmann's distribution, roughness m */
    PEL_SPECULAR_GGX = 1  /* two lobes of GGX of widths roughness and roughness2, mixed by lobeMix */
} PelSpecularModel;

/* How diffuse light spreads under the surface. A method that this build lacks is an error at commit.
 */
typedef enum PelScattering {
    PEL_SCATTERING_NONE = 0, /* not at all: Lambert, with a sharp shadow */
    /* by the tables, from curvature, blurred normals and wide shadows [Penner 2011] */
    PEL_SCATTERING_PREINTEGRATED = 1,
    /* two filters across the screen, from irradiance per pixel [Jimenez et al. 2015] */
    PEL_SCATTERING_SEPARABLE = 2,
    PEL_SCATTERING_SCREEN = 3,  /* the profile summed over the screen, from irradiance per pixel */
    PEL_SCATTERING_LIGHT = 4,   /* the profile summed over the light's shadow map */
    PEL_SCATTERING_TEXTURE = 5, /* irradiance in texture space [d'Eon, Luebke 2007] */
    /* the method that the inputs allow, with the least work for PelShaderOptions.targetError: on the screen
     * where there are positions or depth, and shadows that are sharp or can be made so; by tables otherwise,
     * and where the material brings its own; without inputs for either, like PREINTEGRATED without tables
     * (docs/guide/shading.md, "Auto"). pelShaderGetWarnings and PelShaderStats report the choice */
    PEL_SCATTERING_AUTO = 6
} PelScattering;

typedef struct PelMaterial {
    uint32_t structSize;
    float albedo[3]; /* used when PEL_SLOT_ALBEDO is not set */
    /* length; default 0: that of the curvature LUT, else of the shadow LUT, else skin's 2.7 mm. Where it
     * differs from a LUT's, look-ups are rescaled */
    float diffusionRadius;
    /* how far the blurred normal replaces the shading normal, per channel: the channel that scatters widest
     * sees the blurred normal only. Default -1: the profile's; without one 1, 0.3, 0 */
    float normalBlend[3];
    /* length: penumbra of the wide shadow where the surface faces the light. Default 0: 1.3 times the
     * profile's largest width; without a profile 8 mm */
    float shadowFilterWidth;
    float deepScatterColor[3]; /* 0: no deep scatter */
    float deepScatterRadius;   /* length, sigma of the transmission through thickness; 6 mm */
    /* length the position moves inwards before thickness is measured; 0.2 mm */
    float deepScatterNormalOffset;
    float thicknessFilterRadius; /* radius of the disk of taps, in UV of the shadow map; 0.02 */
    uint32_t thicknessTaps;      /* 8, 16 or 32; 0: thickness is not measured */
    float specular;              /* rho_s; 0: no specular */
    float roughness;             /* m of Beckmann; 0.3 */
    float f0;                    /* reflectance at normal incidence; 0.028 */
    /* length per unit of u or v on the surface, from pelMeshUvScale. It decides which level of the normal map
     * is blurred over diffusionRadius; 1 */
    float uvScale;
    PelSpecularModel specularModel;
    float roughness2; /* of the second lobe of GGX; multiplied by the roughness image too; 0.15 */
    float lobeMix;    /* its share, 0 to 1; 0.15 */
    /* share of ambient light that comes through from behind: times deepScatterColor and the irradiance on
     * -Nb. Needs PEL_SLOT_THICKNESS, measured along the inward normal: off without it, also with shadow maps;
     * 0 */
    float deepScatterAmbient;
    /* PEL_SCATTERING_AUTO. All but PEL_SCATTERING_PREINTEGRATED take shadows from maps sharp: compared about
     * a texel wide, whatever the filter's fields of PelLight say */
    PelScattering scattering;
    /* in mm; the shader keeps it alive. Everything left to defaults follows from it: both tables (made, and
     * kept for the device), widths, normal blend, transmission. NULL: none */
    PelProfile profile;
    /* share of the light that the profile lets through thin parts (pelProfileTransmission of the thickness
     * along the light, times max(-Ng.L, 0)): the larger of this and the table's dark side is used. Needs a
     * profile, and a thickness image or a shadow map with thicknessTaps; a deepScatterColor replaces it; 1 */
    float transmission;
    /* a curved body reflects more than a half-space of its medium, a hollow less: diffuse light is multiplied
     * by max(0, 1 + a x / (1 + b |x|)), x = curvatureGain * mean free path * H, H the mean curvature
     * (PEL_SLOT_MEAN_CURVATURE); a and b follow from the medium's albedo, 1.36 and 3 at a reflectance of 0.8.
     * All methods that scatter (by tables: with PEL_SLOT_CURVATURE), where there are positions, depth or H,
     * and the profile is burley or dipole: other profiles have no known mean free path, and get no gain.
     * 0: no gain; 1 */
    float curvatureGain;
    /* 0, or 8 to 256. PEL_SCATTERING_SEPARABLE: taps of each of the two filters; 0: 25.
     * PEL_SCATTERING_SCREEN: taps on a disk, placed by the profile; 0: the whole profile. Other methods
     * ignore it; 0 */
    uint32_t scatterTaps;
    /* 0 to 1, m: irradiance is multiplied by albedo^m before it scatters and by albedo^(1 - m) after: the
     * larger m, the more scattering softens the texture. For methods that scatter irradiance; 0 */
    float albedoBefore;
    /* 0 to 1: share of the light that flows in from materials of other ids, where those scatter too. 0:
     * nothing; 1: as if there were no border. Nothing flows from materials that do not scatter, such as eyes
     * and teeth of PEL_SCATTERING_NONE; 0 */
    float borderColor[3];
    /* length. Above 0: the surface is a sheet this thick, a leaf or paper: light on its other side is
     * transmitted according to pelProfileTransmission, times `transmission`, with the shadow of this side.
     * Needs a profile and a method that reads irradiance; 0 */
    float thinThickness;
} PelMaterial;

/* Light from everywhere: E(n) = constant + sum of sh[i] * basis_i(n) over the 9 orthonormal real spherical
 * harmonics of orders 0 to 2, in the order 1; y, z, x; xy, yz, 3z^2-1, xz, x^2-y^2. The values are irradiance
 * / pi (the cosine already convolved in), so that albedo * E is radiance. Negative sums count as 0. All zero:
 * no ambient. */
typedef struct PelAmbient {
    uint32_t structSize;
    float constant[3];
    float sh[9][3];
} PelAmbient;

typedef struct PelCamera {
    uint32_t structSize;
    /* world, up to 1e18; needed by specular and, with a parallel or default matrix, by methods that sum light
     * (which side of a surface is outside). Parallel views: a point far behind the camera */
    float position[3];
    /* clip to world, for PEL_SLOT_DEPTH, historyWeight, PEL_SCATTERING_SEPARABLE and scatterTaps. x and y in
     * [-1, 1], y up, row 0 on top; z as in the depth image, so that ordinary and reversed depth both work */
    float inverseViewProjection[16];
} PelCamera;

/* An eyeball as an optical instrument, around a material that is its sclera. Lengths are in mm, whatever the
 * scene's unit (PelShaderOptions.millimetresPerUnit); place and directions are in world space. The eye's
 * surface is this model's: the G-buffer only says which pixels show it, so the cornea is smooth however
 * coarse the mesh, and also where the mesh is a plain ball. Sources: Le Grand and El Hage, Physiological
 * Optics, 1980; Navarro, Santamaria, Bescos, JOSA A 2, 1985. */
typedef struct PelEye {
    uint32_t structSize;
    float center[3];    /* of the sclera's sphere, units of positions */
    float gaze[3];      /* the direction in which it looks, of any length; 0, 0, 1 */
    float up[3];        /* towards the top of the iris' texture, not along gaze, of any length; 0, 1, 0 */
    float scleraRadius; /* mm; 12 [Le Grand] */
    float corneaRadius; /* mm, of curvature at its apex; 7.8 [Le Grand] */
    float corneaConic;  /* conic constant: 0 is a sphere, -1 a paraboloid; -0.26 [Navarro] */
    float limbusRadius; /* mm, of the circle in which cornea and sclera meet; 6 */
    float limbusWidth;  /* mm, of the soft border between them, inwards from there; 1 */
    /* 0 to 1: share of the light that the iris' rim absorbs where the border begins; grows with the slant of
     * the view; 0.6 */
    float limbusDarkening;
    /* mm, from the cornea's apex to the plane of the iris' rim; 3.05 [Le Grand, Navarro] */
    float chamberDepth;
    /* refractive index, 1 to 3; 1.376 [Navarro]. The cornea has no thickness, but reflects on both of its
     * sides */
    float corneaIndex;
    float aqueousIndex; /* of the aqueous humour, 1 to 3; 1.336 [Le Grand] */
    float irisRadius;   /* mm; 0: limbusRadius */
    /* mm, how much deeper than its rim the iris' centre lies: a paraboloid; 0: a plane */
    float irisConcavity;
    float pupilRadius; /* mm, less than the iris'; 2 */
    /* 0 to 0.95: radius of the pupil in the iris' texture, as a share of its rim's; 0.3. Between pupil and
     * rim the texture is stretched evenly */
    float texturePupil;
    /* multiplies the texture, or colours the fibres of an iris without one; -1: 1 with a texture, else 0.22,
     * 0.12, 0.06; -1 */
    float irisColor[3];
    uint32_t irisSeed;      /* seed of the fibre pattern of an iris without a texture; 0 */
    float tearRoughness;    /* of the film of tears: GGX's alpha, 0.001 to 1; 0.03 */
    float wetLineRoughness; /* the same where PEL_SLOT_WETNESS is 1; 0.2 */
    float tearIndex;        /* refractive index of the film, 1 to 3; 1: no reflection; 1.336 */
    /* in mm: how light scatters in the iris. NULL: not at all. The sclera's is PelMaterial.profile */
    PelProfile irisProfile;
} PelEye;

typedef enum PelFeature {
    PEL_FEATURE_DIRECT_SCATTER = 1 << 0, /* curvature image and a curvature LUT */
    PEL_FEATURE_SHADOW = 1 << 1,         /* a wide shadow image */
    PEL_FEATURE_SHADOW_LUT = 1 << 2,     /* and a shadow LUT */
    PEL_FEATURE_AMBIENT = 1 << 3,
    PEL_FEATURE_DEEP_SCATTER = 1 << 4,   /* deepScatterColor, and thickness from an image or taps */
    PEL_FEATURE_THICKNESS_TAPS = 1 << 5, /* deep scatter with a shadow map */
    PEL_FEATURE_SPECULAR = 1 << 6,
    PEL_FEATURE_BLUR_NORMALS = 1 << 7,     /* PelShaderOptions.blurNormals, and no blurred normal image */
    PEL_FEATURE_NORMAL_MAP = 1 << 8,       /* blurred normals from the normal map of a material */
    PEL_FEATURE_FILTER_SHADOW = 1 << 9,    /* a wide shadow made from a shadow map */
    PEL_FEATURE_GGX = 1 << 10,             /* specular with PEL_SPECULAR_GGX */
    PEL_FEATURE_AMBIENT_SCATTER = 1 << 11, /* deepScatterAmbient, ambient light and a thickness image */
    PEL_FEATURE_OUTPUTS = 1 << 12,         /* an output beside radiance */
    PEL_FEATURE_AMBIENT_CUBE = 1 << 13,    /* ambient light from a cube map */
    PEL_FEATURE_IRRADIANCE = 1 << 14, /* a material whose diffuse light comes from irradiance per pixel */
    /* the shader makes that irradiance: there is no PEL_SLOT_IRRADIANCE */
    PEL_FEATURE_MAKE_IRRADIANCE = 1 << 15,
    PEL_FEATURE_TRANSMISSION = 1 << 23,    /* PelMaterial.transmission, and thickness from an image or taps */
    PEL_FEATURE_SHADOW_CUBE = 1 << 24,     /* a shadow map of a cube, for thickness or a wide shadow */
    PEL_FEATURE_SHADOW_CASCADES = 1 << 25, /* cascades, for thickness or a wide shadow */
    PEL_FEATURE_SHADOW_EXPONENTIAL = 1 << 26, /* PEL_SHADOW_CONTENT_EXPONENTIAL, for the same */
    PEL_FEATURE_SHADOW_MOMENTS = 1 << 27,     /* PEL_SHADOW_CONTENT_MOMENTS, for the same */
    PEL_FEATURE_EYE = 1 << 28,                /* a material is an eye (pelShaderSetEye) */
    PEL_FEATURE_REFLECTION_CUBE = 1 << 29,    /* an eye, and a cube map that it reflects */
    PEL_FEATURE_ENVIRONMENT = 1 << 30         /* specular light of the surroundings */
} PelFeature;

/* Statistics of a shader: counts of its last execution unless marked as total; 0 from a commit to the next
 * execution. */
typedef struct PelShaderStats {
    uint32_t structSize;
    uint32_t features;      /* PelFeature bits, derived at commit */
    uint64_t programsBuilt; /* total */
    uint64_t launches;
    uint64_t scratchBytes;  /* device memory held beside the caller's images */
    uint64_t bytesUploaded; /* shading constants and tables sent since the previous execution */
    uint64_t tilesTotal;
    uint64_t tilesShaded; /* with at least one pixel of a material */
    uint64_t pixelsTotal;
    /* of a material. This and pixelsInvalid are always counted, the others of pixels and texels with
     * PelShaderOptions.countPixels */
    uint64_t pixelsShaded;
    uint64_t pixelsShadowLut; /* that read the shadow LUT, summed over lights, like the next two */
    uint64_t pixelsThickness; /* that took thickness taps */
    uint64_t pixelsSpecular;
    /* of a material, with NaN or Inf in an input, in the result, or in the radiance that it is added to: they
     * get PelShaderOptions.invalidColor */
    uint64_t pixelsInvalid;
    double deviceMilliseconds; /* kernels; 0 on a queue without profiling */
    uint64_t pixelsWideShadow; /* whose wide shadow was filtered from a shadow map, summed over lights */
    /* rows of tiles are shaded in this many rounds, to keep to PelShaderOptions.scratchBudget */
    uint64_t bands;
    uint64_t variants;     /* of the shading kernel, each with a tile list of its own */
    uint64_t tilesPartial; /* shaded by a variant with fewer features than the shader has */
    /* of pixelsWideShadow: whose filter read texels. The others were decided by bounds of the map's blocks */
    uint64_t pixelsShadowTexels;
    uint64_t pixelsIrradiance;      /* whose irradiance was made */
    uint64_t pixelsByScattering[7]; /* shaded, by PelMaterial.scattering */
    /* Methods that scatter irradiance per pixel. */
    /* of 16 x 16 pixels, in which a method took taps: by the method. Methods that auto chose count as
     * themselves */
    uint64_t tilesByScattering[7];
    uint64_t pixelsScattered; /* that took taps */
    /* that kept their irradiance, because scattering would not change it or no surface was in reach */
    uint64_t pixelsKept;
    uint64_t scatterTaps; /* pixels and blocks of pixels that were read, modulo 2^32 */
    /* of materials of PEL_SCATTERING_AUTO: by the method that was chosen for them; NONE: kept their
     * irradiance */
    uint64_t pixelsByChoice[7];
    uint64_t pixelsEye;     /* of materials that are eyes */
    uint64_t pixelsIris;    /* of those: that show the iris, outside its pupil */
    uint64_t pixelsCaustic; /* of those: that read the caustic table, summed over lights */
    /* shaded by a variant with code for eyes. With a material image: those that hold an eye */
    uint64_t tilesEye;
    /* 1: substitute materials are committed while programs are being built
     * (PelShaderOptions.buildInBackground) */
    uint64_t standsIn;
    /* with PelShaderOptions.timeBudget: the error that auto aims at in place of targetError, and what to
     * expect of the frame: milliseconds beyond plain lighting, from the 90th percentile of times over the
     * record's scenes, and RMS error against light, a share of white. 0 without a budget or without materials
     * of auto */
    double takenTargetError;
    double expectedMilliseconds;
    double expectedError;
    uint64_t tuned;         /* 1: they come from this device's record, 0: from the built-in guess */
    uint64_t pixelsHistory; /* that took light from the last frame (PelShaderOptions.historyWeight) */
    uint64_t takenHalfRate; /* 1: for the time budget, light is summed as with PelShaderOptions.halfRate */
    /* of shadow maps, within reach of pixels that scatter. Other texels are skipped */
    uint64_t texelsReached;
} PelShaderStats;

/* Statistics of a pass of a shader in one execution. */
typedef struct PelPassStats {
    uint32_t structSize;
    uint32_t launches;
    double milliseconds; /* of the device; 0 on a queue without profiling */
    uint64_t bytes;      /* of device memory that the pass holds now */
    uint64_t tiles;      /* of 128 x 2 pixels over which it was launched, over bands; 0: not over tiles */
    uint64_t execution;  /* which: 1 is the shader's first */
    char name[24];       /* of its kernel file if it has one, such as "irradiance" */
} PelPassStats;

/* Device memory of a pass of a shader. */
typedef struct PelPassMemory {
    uint32_t structSize;
    char name[28];   /* as in PelPassStats; the last is "constants" */
    uint64_t held;   /* bytes, now */
    uint64_t needed; /* bytes that it will hold once the state that is set is committed; 0: not needed then */
} PelPassMemory;

/* How the shading kernel finds its tiles. All give the same bits. */
typedef enum PelTileLists {
    PEL_TILES_ONE_LIST = 0, /* one list of all tiles with a material */
    /* a list per variant: tiles whose materials need fewer features are shaded by a smaller kernel. Faster if
     * nearly all tiles do (docs/guide/shading.md, "Tiles") */
    PEL_TILES_PER_VARIANT = 1,
    PEL_TILES_NO_LIST = 2 /* every tile is visited, and skipped if it has no material; for measurements */
} PelTileLists;

typedef struct PelShaderOptions {
    uint32_t structSize;
    /* 1: radiance is added to the output image; 0: it replaces pixels that have a material */
    uint32_t accumulate;
    /* 1: shade every tile and evaluate every term, for tests; gives the same bits */
    uint32_t disableSkipping;
    uint32_t countPixels;  /* 1: fill all pixel counters of PelShaderStats, at some cost */
    float invalidColor[3]; /* radiance of a pixel with a NaN or Inf input; default 0 */
    /* 1: without PEL_SLOT_NORMAL_BLURRED, blurred normals are shading normals blurred on screen over
     * PelMaterial.diffusionRadius; needs positions or depth */
    uint32_t blurNormals;
    /* 1: the disk of thickness taps is rotated by an angle that depends only on the pixel's column and row,
     * so that few taps give noise, not bands (docs/guide/shading.md, "Rotated disk of taps") */
    uint32_t rotateTaps;
    /* limit in bytes for images that the passes make (blurred normals, wide shadows): larger frames are
     * shaded in bands of rows, with the same bits as a result, unless an output overwrites ids, positions,
     * depth or normals. 0: no limit, and bands only when memory runs out */
    uint64_t scratchBudget;
    PelTileLists tileLists;
    /* for methods that leave out small contributions: the error that they may make, as a share of white, 0 to
     * 1; 0.002 */
    float targetError;
    /* of positions, > 0: profiles are in mm, every other length in the scene's unit; 1 */
    float millimetresPerUnit;
    /* varies the random positions of scattering taps from frame to frame, for hosts that average frames. The
     * same number gives the same bits; 0 */
    uint32_t frameIndex;
    /* 1: PEL_SCATTERING_LIGHT, PEL_SCATTERING_SEPARABLE, and PEL_SCATTERING_SCREEN with scatterTaps compute
     * every second pixel along both axes. For the other pixels, light from beyond the pixel is interpolated
     * on the same surface, and light from within it is computed: a quarter of the taps
     * (docs/guide/shading.md, "Half rate"); 0 */
    uint32_t halfRate;
    /* 1: wide shadows that the shader filters, and thickness by taps, are computed at every pixel. 0, the
     * default: shadows are computed at every second pixel along both axes, and interpolated where material,
     * surface and values are continuous (docs/guide/shading.md, "Between pixels"); thickness between nodes of
     * a grid in the shadow map, where that is as accurate (the same page, "Cells of taps") */
    uint32_t everyPixel;
    /* 1: pelShaderCommit does not wait for programs that are neither in memory nor on disk. They are built
     * while the caller goes on, and until the first execution after that the materials shade by
     * PEL_SCATTERING_NONE, without specular light, light through thin parts, normal maps and eyes
     * (PelShaderStats.standsIn; docs/guide/devices.md, "The first picture"). Errors of the build are those of
     * the execution or commit that finds them. 0 */
    uint32_t buildInBackground;
    /* milliseconds of the device that materials of PEL_SCATTERING_AUTO may take beyond plain lighting; 0: as
     * many as targetError needs. pelShaderCommit then counts their pixels in the material image (all of the
     * frame if it shows none yet), waiting for what is queued, and takes the method and the error, not below
     * targetError, that are nearest to light among those that fit. Times are from the device's record: a file
     * of PELLUCID_TUNING, or a guess (docs/guide/shading.md, "Time budget"). PelShaderStats has both; 0 */
    float timeBudget;
    /* pixels: the part of all images of the frame that is shaded, for images that are larger than the
     * viewport (docs/guide/hosts.md, "A part of the images"). Its pixels have no neighbours outside, as if
     * the images were cropped to it; pixels outside are not written, and the clip space of PelCamera spans
     * it. Errors at commit: it is not inside the images. regionWidth 0: the whole images; 0 */
    uint32_t regionX;
    uint32_t regionY;
    uint32_t regionWidth;
    uint32_t regionHeight;
    /* 0 to 0.95: share of earlier frames in the scattered light of materials that scatter by taps
     * (PEL_SCATTERING_SEPARABLE, and PEL_SCATTERING_SCREEN with scatterTaps). After n frames it is at most n
     * / (n + 1), so that a picture at rest becomes the mean of all. Light is read at the position that
     * PEL_SLOT_MOTION gives, if material and distance match the pixel's, and clamped to the range of this
     * frame's light in the 3 x 3 pixels around. Needs PelCamera.inverseViewProjection; frameIndex should
     * change from frame to frame (docs/guide/shading.md, "History"); 0 */
    float historyWeight;
    /* if it differs from the last execution's, nothing is taken from earlier frames, as after a cut. Another
     * size and a commit without history have the same effect; 0 */
    uint32_t historyCut;
} PelShaderOptions;

PEL_API PelError pelShaderCreate(PelDevice device, PelShader* shader);
PEL_API void pelShaderRetain(PelShader shader);
PEL_API void pelShaderRelease(PelShader shader);
PEL_API PelError pelShaderSetOptions(PelShader shader, const PelShaderOptions* options);
/* A NULL image clears the slot. */
PEL_API PelError pelShaderSetImage(PelShader shader, PelImageSlot slot, const PelImageDesc* image);
/* Material `id`, 1 to 255; a NULL material removes it. Either LUT may be NULL: then it is made from the
 * profile; without a profile there is no direct scattering, and the shadow is plain. */
PEL_API PelError pelShaderSetMaterial(PelShader shader, uint32_t id, const PelMaterial* material,
                                      PelLut curvatureLut, PelLut shadowLut);
/* The tangent-space normal map of material `id`, which must be set: `levels` images, each half the size of
 * the one before, all in one buffer and of one format with three components (unorm: 2x - 1; float:
 * unchanged), repeated beyond [0, 1]. Without PEL_SLOT_NORMAL_BLURRED, the blurred normal is read from it:
 * trilinear, at level log2(max(size * diffusionRadius, uvScale) / uvScale), but never sharper than the
 * pixel's own level of detail. A count of 0 removes it. Source: FaceWorks 1.0. */
PEL_API PelError pelShaderSetNormalMap(PelShader shader, uint32_t id, const PelImageDesc* levels,
                                       uint32_t count);
/* Light that was scattered in the texture of material `id`, which must be set, by pelTextureScatterExecute or
 * otherwise: RGB, float or half or unorm. Read by materials of PEL_SCATTERING_TEXTURE instead of their
 * irradiance: bilinear at PEL_SLOT_UV, which they need, texel centres at (i + 1/2) / size, row 0 at v = 0,
 * repeated beyond [0, 1]. Where it is black, irradiance stays. Read at each execution. NULL removes it. */
PEL_API PelError pelShaderSetScatteredTexture(PelShader shader, uint32_t id, const PelImageDesc* texture);
/* Makes material `id`, which must be set, an eye; at most 64 are. The material is its sclera; iris, pupil,
 * limbus and film of tears come from `eye`. Needs PEL_SLOT_POSITION or _DEPTH, and PelCamera.position.
 * `caustics`: a table of pelEyeLutCreate; NULL: it is made for this eye, and kept. NULL for `eye`: the
 * material is no longer an eye. Removing the material removes its eye. Errors: PEL_ERROR_INVALID_ARGUMENT for
 * parts that do not fit together, such as a pupil wider than the iris; the message names the field. */
PEL_API PelError pelShaderSetEye(PelShader shader, uint32_t id, const PelEye* eye, PelLut caustics);
/* The albedo of the iris of material `id`, which must be an eye: a square image whose inscribed circle is the
 * iris' rim, as seen by a viewer who faces the eye, row 0 at PelEye.up; a colour format; bilinear. Read at
 * the first execution after the commit that follows this call. NULL removes it: fibres are drawn by
 * PelEye.irisSeed. */
PEL_API PelError pelShaderSetIrisTexture(PelShader shader, uint32_t id, const PelImageDesc* texture);
/* The surroundings that eyes reflect: radiance / pi, six faces as in pelShaderSetAmbientCube, as sharp as the
 * film of tears should show them. Bilinear; negative values count as 0. Read at each execution. NULL removes
 * it. Other materials do not read it. */
PEL_API PelError pelShaderSetReflectionCube(PelShader shader, const PelImageDesc* faces);
/* The surroundings as light: radiance, in an equirectangular image (2n x n pixels, the upper edge +y, the
 * middle column +z, +x to the left of it, as in OpenEXR) or in six faces as in pelShaderSetAmbientCube; a
 * colour format. Gives ambient light, beside PelAmbient; specular light to materials with `specular`, for
 * which positions or depth are needed; and reflections to eyes. An ambient cube or a reflection cube, if set,
 * replaces that part of it. `axes`: three rows of three, the image's x, y and z axis in the world; NULL: the
 * world's. It is reduced to 64 x 64 texels a face at the first execution after the commit that follows this
 * call. Negative values, NaN and Inf count as 0. NULL for `image` removes it. Errors:
 * PEL_ERROR_INVALID_ARGUMENT for another shape, or axes that are not unit vectors at right angles. Sources:
 * Karis, SIGGRAPH courses 2013; docs/mathematics.md, section 6. */
PEL_API PelError pelShaderSetEnvironment(PelShader shader, const PelImageDesc* image, const float* axes);
/* Replaces all lights, 0 to 64 of them; images of lights beyond the count are cleared. */
PEL_API PelError pelShaderSetLights(PelShader shader, const PelLight* lights, uint32_t count);
PEL_API PelError pelShaderSetLightImage(PelShader shader, uint32_t light, PelLightSlot slot,
                                        const PelImageDesc* image);
PEL_API PelError pelShaderSetAmbient(PelShader shader, const PelAmbient* ambient);
/* An irradiance cube map, added to PelAmbient: irradiance / pi (the cosine already convolved in) of the six
 * normals +x, -x, +y, -y, +z, -z and those between. Six square faces in one image, one below the other
 * (height = 6 * width) or side by side (width = 6 * height); a colour format. With s to the right and t
 * down, both from -1 to 1, a face's point (s, t) is the normal
 *     +x ( 1, -t, -s)   +y (s,  1,  t)   +z ( s, -t,  1)
 *     -x (-1, -t,  s)   -y (s, -1, -t)   -z (-s, -t, -1)
 * as in OpenGL, Direct3D and Vulkan. Bilinear, without seams between faces; negative values count as 0.
 * Read at each execution. NULL removes it. Errors: PEL_ERROR_INVALID_ARGUMENT for another shape or a
 * format without colour. */
PEL_API PelError pelShaderSetAmbientCube(PelShader shader, const PelImageDesc* faces);
PEL_API PelError pelShaderSetCamera(PelShader shader, const PelCamera* camera);
/* Checks that everything fits together, derives the features and builds the programs that they need. */
PEL_API PelError pelShaderCommit(PelShader shader);
/* Shades. A blocking call reports progress to the device's callback about every million pixels; if that
 * cancels, some pixels are shaded and others not. Errors: PEL_ERROR_CANCELLED; PEL_ERROR_INVALID_STATE if a
 * setting was changed after the last commit. */
PEL_API PelError pelShaderExecute(PelShader shader, const PelSubmit* submit);
/* Material `id` as it is shaded: each default is replaced by its value, and after a commit AUTO by the chosen
 * method. profile is NULL. */
PEL_API PelError pelShaderGetMaterial(PelShader shader, uint32_t id, PelMaterial* material);
/* Warnings of the last commit: settings without effect, and unlikely values. One sentence a line; "" if none.
 * Valid until the shader's next commit or execution, or its release. */
PEL_API PelError pelShaderGetWarnings(PelShader shader, const char** warnings);
/* Waits for the last execution. */
PEL_API PelError pelShaderGetStats(PelShader shader, PelShaderStats* stats);
/* The passes that launched something in the newest execution that has finished, in their order. Does not
 * wait. passes[0].structSize is the size of each. `count`: room in `passes`, 24 suffice; receives how many
 * there are, 0 while no execution has finished. Errors: PEL_ERROR_INVALID_ARGUMENT for too little room. */
PEL_API PelError pelShaderGetPasses(PelShader shader, PelPassStats* passes, uint32_t* count);
/* Device memory of the passes besides the caller's images, now and after a commit of the current settings.
 * Nothing is committed and no image allocated; tables of profiles and eyes are made where they are missing.
 * Arrays as in pelShaderGetPasses. Errors: those of pelShaderCommit. */
PEL_API PelError pelShaderGetMemory(PelShader shader, PelPassMemory* passes, uint32_t* count);

/* ---- Reference --------------------- */

/* The element that each value of PelSurfaceIntegralDesc.irradiance belongs to. */
typedef enum PelIrradianceAt {
    PEL_IRRADIANCE_VERTEX = 0,   /* one per vertex, linear on triangles */
    PEL_IRRADIANCE_TRIANGLE = 1, /* one per triangle, constant on it */
    PEL_IRRADIANCE_CORNER = 2    /* one per index: linear on triangles, with steps at edges */
} PelIrradianceAt;

/* A lit mesh, and the points where the scattered light is wanted. Arrays are the host's, read during the
 * call. */
typedef struct PelSurfaceIntegralDesc {
    uint32_t structSize;
    uint32_t numVertices;
    const float* positions;  /* xyz per vertex, units of positions */
    const uint32_t* indices; /* numIndices, three per triangle; either order */
    uint64_t numIndices;
    /* RGB, 0 or more, with visibility: pi times the radiance of a white Lambertian surface, or in any other
     * unit, which is then that of the result */
    const float* irradiance;
    PelIrradianceAt irradianceAt;
    PelProfile profile;    /* NULL: skin */
    float diffusionRadius; /* unit of the profile, millimetres for skin; 0: the profile's own */
    /* units of the profile per unit of positions: 10 for a mesh in centimetres; 1 */
    float millimetresPerUnit;
    /* unit of the profile; from this distance on R is 0, and the rest is scaled to 1 on a plane; per channel;
     * 0: R is not cut */
    float cut[3];
    /* bound of the error of the hierarchy, relative to the largest irradiance, 1e-7 to 1; 1e-3, which in
     * practice gives 1e-5 */
    float tolerance;
    /* xyz float32 each, units of positions; on the triangles: a point above them gets too little */
    PelVertexView points;
    /* RGB float32 each, written, in units of irradiance; 0 for a point that is not finite */
    PelVertexView result;
} PelSurfaceIntegralDesc;

/* Light that leaves a surface after diffusing under it: the sum over all of the surface of R(distance) times
 * irradiance, by the straight distance, not renormalised. Every diffusion method here approximates this.
 * Multiplied by the albedo it compares with diffuse radiance. Near triangles are integrated exactly for
 * irradiance that is linear on them, however steep R is; far sets of triangles count as points, with an error
 * of at most `tolerance` on a plane, and in proportion to the area in reach elsewhere. The remaining error is
 * that of the mesh: facets, and irradiance that is not linear on them (the edge of a shadow needs triangles
 * of a quarter of the narrowest channel's width). Work grows with the number of points and the logarithm of
 * that of triangles. The mesh is sorted on the host first. Blocking calls report progress to the device's
 * callback. Same input, same bits. Errors: PEL_ERROR_INVALID_ARGUMENT for numbers that are not finite or
 * negative (the message names the vertex), indices beyond the vertices, points and result of different
 * length. Source: mathematics, section 9. */
PEL_API PelError pelSurfaceIntegral(PelDevice device, const PelSurfaceIntegralDesc* desc,
                                    const PelSubmit* submit);

/* ---- Scattering alone --------------------- */

/* For hosts that light their own frames: takes the irradiance of a picture and returns it scattered under the
 * surface. Keeps memory between frames (PelScatterStats.scratchBytes). One thread at a time. */
typedef struct PelScatterObject* PelScatter;

typedef struct PelScatterParams {
    uint32_t structSize;
    /* share of white by which 99 % of the pixels may differ from the result of `everywhere`: pixels and
     * blocks that change little are left out; below 0.002 it is an aim, not a promise; 0.002 */
    float targetError;
    float white;         /* irradiance that counts as white; 1 */
    uint32_t everywhere; /* 1: leave nothing out anywhere; 0 */
    /* clip to world, as in PelCamera. Needed with depth. With positions a perspective matrix tells grazing
     * angles and which side of a surface is outside, so curved parts are more accurate; it may be all zero;
     * default */
    float inverseViewProjection[16];
    /* 1: the result is added to `out`, which then is another image than the irradiance; 0 */
    uint32_t accumulate;
    uint32_t frameIndex; /* as PelShaderOptions.frameIndex; 0 */
    uint32_t halfRate;   /* as PelShaderOptions.halfRate; 0 */
} PelScatterParams;

/* How a material of a PelScatter scatters, beside its profile. */
typedef struct PelScatterControls {
    uint32_t structSize;
    PelScattering scattering; /* PEL_SCATTERING_SCREEN or PEL_SCATTERING_SEPARABLE; SCREEN */
    uint32_t scatterTaps;     /* this and the next three as in PelMaterial */
    float albedoBefore;
    float borderColor[3];
    float thinThickness; /* units of positions; needs PEL_SLOT_IRRADIANCE_BACK */
} PelScatterControls;

typedef struct PelScatterStats {
    uint32_t structSize;
    uint32_t launches;
    uint64_t pixelsTotal;
    uint64_t pixelsCovered; /* with a material */
    uint64_t pixelsTapped;  /* that were gathered; the others kept their irradiance */
    uint64_t pixelsInvalid; /* NaN or Inf in irradiance or position: unchanged, and used by no neighbour */
    uint64_t tilesCovered;  /* of 16 x 16 pixels */
    uint64_t tilesTapped;
    uint64_t taps; /* pixels and blocks of pixels that were read, modulo 2^32 */
    uint64_t scratchBytes;
    double deviceMilliseconds;     /* of devices that measure */
    uint64_t tilesByScattering[7]; /* tapped, by PelScatterControls.scattering */
} PelScatterStats;

PEL_API PelError pelScatterCreate(PelDevice device, PelScatter* scatter);
PEL_API void pelScatterRetain(PelScatter scatter);
PEL_API void pelScatterRelease(PelScatter scatter);

/* Pixels of id 1 to 255 scatter by `profile`, `scale`: units of positions per unit of the profile's lengths:
 * 1 if positions are in mm, as profiles are, 0.1 for cm; twice that for twice the radius. 0 or a NULL
 * profile: no scattering. The object keeps the profile alive. */
PEL_API PelError pelScatterSetMaterial(PelScatter scatter, uint32_t id, PelProfile profile, float scale);

/* How pixels of material `id`, which must be set, scatter; NULL: the defaults. */
PEL_API PelError pelScatterSetControls(PelScatter scatter, uint32_t id, const PelScatterControls* controls);

/* A further image for the next executions, of the same size as the others, until it is replaced, or removed
 * by NULL: PEL_SLOT_SCATTER_WEIGHT; PEL_SLOT_IRRADIANCE_BACK; PEL_SLOT_ALBEDO: the irradiance then must not
 * include albedo, and the result does; it is radiance if the input was irradiance / pi. One of
 * PEL_SLOT_NORMAL_GEOMETRIC and PEL_SLOT_MEAN_CURVATURE turns on the gain of curved bodies, as PelMaterial's
 * curvatureGain of 1 does, for profiles whose medium is known; the curvature is measured from normals if it
 * is not given. */
PEL_API PelError pelScatterSetImage(PelScatter scatter, PelImageSlot slot, const PelImageDesc* image);

/* `irradiance`: linear RGB, all lights together, shadows sharp, without or with albedo; `positions`: world,
 * or `depth` with params.inverseViewProjection and positions NULL; `ids`: of materials, 0 is background;
 * NULL: everything is id 1. `out`: a float or half image of 3 or 4 components, written; may be the irradiance
 * itself. Nothing flows between ids, or over a gap in depth wider than the profile reaches. All images have
 * one size. `params` may be NULL. Sources: d'Eon and Luebke, GPU Gems 3 (the sum); docs/mathematics.md,
 * sections 9 and 10. */
PEL_API PelError pelScatterExecute(PelScatter scatter, const PelScatterParams* params,
                                   const PelImageDesc* irradiance, const PelImageDesc* positions,
                                   const PelImageDesc* depth, const PelImageDesc* ids,
                                   const PelImageDesc* out, const PelSubmit* submit);

/* Of the last execution; waits for it. */
PEL_API PelError pelScatterGetStats(PelScatter scatter, PelScatterStats* stats);

/* ---- Scattering in texture space --------------------- */

/* Irradiance of a mesh, drawn into its texture and scattered there: independent of the view, so it may be
 * kept while neither mesh nor light moves. Keeps memory between executions. One thread at a time. Source:
 * d'Eon and Luebke, GPU Gems 3, chapter 14; docs/mathematics.md, section 7. */
typedef struct PelTextureScatterObject* PelTextureScatter;

typedef struct PelTextureScatterDesc {
    uint32_t structSize;
    uint32_t width; /* texels, 1 to 16384 each */
    uint32_t height;
    uint32_t numVertices;
    const uint32_t* indices; /* numIndices, three per triangle; read during the call only */
    uint64_t numIndices;     /* a multiple of 3 */
    /* u, v per vertex, uvStride bytes apart, in [0, 1]; read during the call only. Where triangles overlap in
     * the texture, the later one counts */
    const float* uvs;
    uint32_t uvStride; /* bytes; 0: 8 */
} PelTextureScatterDesc;

typedef struct PelTextureScatterParams {
    uint32_t structSize;
    PelProfile profile; /* NULL: skin */
    float scale;        /* units of positions per unit of the profile, > 0: 0.1 for cm; 1 */
    float albedoBefore; /* as in PelMaterial, with the albedo that the execution is given; 0 */
    /* 1: the result is multiplied by albedo^(1 - albedoBefore); 0: the reader of the texture does that, as a
     * PelShader does; 0 */
    uint32_t albedoAfter;
    /* 2 to 12: number of Gaussians for profiles that are not a sum of as many or fewer; 6 */
    uint32_t gaussians;
} PelTextureScatterParams;

typedef struct PelTextureScatterStats {
    uint32_t structSize;
    uint32_t launches; /* of the last execution */
    uint64_t texelsTotal;
    uint64_t texelsCovered; /* by a triangle */
    uint64_t texelsInvalid; /* irradiance or albedo that is NaN, Inf or above 1e15: not covered */
    uint64_t tilesTotal;    /* of 16 x 16 texels */
    uint64_t tilesBlurred;  /* with a covered texel, summed over Gaussians; other tiles are free */
    uint64_t gaussians;
    /* greatest difference, part of all light, between the profile and its Gaussians: of the light within any
     * distance, over the channels */
    double profileError;
    uint64_t scratchBytes;
    double deviceMilliseconds; /* of devices that measure */
} PelTextureScatterStats;

/* Errors: PEL_ERROR_INVALID_ARGUMENT for indices beyond the vertices, texture coordinates that are not finite
 * (the message names the vertex) or a wrong size. */
PEL_API PelError pelTextureScatterCreate(PelDevice device, const PelTextureScatterDesc* desc,
                                         PelTextureScatter* scatter);
PEL_API void pelTextureScatterRetain(PelTextureScatter scatter);
PEL_API void pelTextureScatterRelease(PelTextureScatter scatter);

/* Where the vertices are: xyz float32, numVertices of them. Measures how the texture is stretched over the
 * mesh. Call it before anything else, and again when the mesh has moved. */
PEL_API PelError pelTextureScatterSetPositions(PelTextureScatter scatter, const PelVertexView* positions,
                                               const PelSubmit* submit);

/* Draws three float32 per vertex into the texture, linear on triangles: irradiance per vertex, or positions
 * and normals, from which a PelShader of PEL_SCATTERING_NONE and albedo 1 makes irradiance with all lights
 * and shadow maps. `out`: RGB or RGBA, float or half, of the texture's size; texels in no triangle get 0, but
 * those within a texel of a triangle its extrapolated value, for bilinear sampling. `unit` 1: values are
 * normals, and are normalised again. */
PEL_API PelError pelTextureScatterDraw(PelTextureScatter scatter, const PelVertexView* values, uint32_t unit,
                                       const PelImageDesc* out, const PelSubmit* submit);

/* `irradiance`: RGB, of the texture's size, the host's own or a drawn one; only texels in triangles count.
 * `albedo`: the same, or NULL: 1. `out`: RGB or RGBA, float or half, written, may be the irradiance:
 * scattered irradiance, also within two texels round triangles. No light flows across seams of the texture,
 * but they do not darken. `params` may be NULL. */
PEL_API PelError pelTextureScatterExecute(PelTextureScatter scatter, const PelTextureScatterParams* params,
                                          const PelImageDesc* irradiance, const PelImageDesc* albedo,
                                          const PelImageDesc* out, const PelSubmit* submit);

/* Of the last execution; waits for it. */
PEL_API PelError pelTextureScatterGetStats(PelTextureScatter scatter, PelTextureScatterStats* stats);

/* ---- Warm-up --------------------- */

/* Groups of programs that do not depend on a G-buffer; bits of PelWarmUp.groups. */
typedef enum PelProgramGroup {
    /* curvature, shadow and specular tables of sums of Gaussians, and their encodings */
    PEL_PROGRAMS_LUTS = 1 << 0,
    PEL_PROGRAMS_TABULATED_LUTS = 1 << 1, /* tables of tabulated profiles, which are not such sums */
    PEL_PROGRAMS_CURVATURE = 1 << 2       /* of meshes by every estimator, smoothing, UV scale */
} PelProgramGroup;

/* The arguments of a pelScatterExecute, of whose images only the formats and packing matter. */
typedef struct PelScatterWork {
    uint32_t structSize;
    PelScatter scatter;
    const PelScatterParams* params;
    const PelImageDesc* irradiance;
    const PelImageDesc* positions;
    const PelImageDesc* depth;
    const PelImageDesc* ids;
    const PelImageDesc* out;
} PelScatterWork;

typedef struct PelWarmUp {
    uint32_t structSize;
    uint32_t groups; /* PelProgramGroup bits; 0: none */
    /* numShaders of this device, with images, materials and lights set as for a commit. Nothing is written to
     * them, and only the formats and packing of images matter: 16 x 1 pixels can represent a frame */
    const PelShader* shaders;
    uint32_t numShaders;
    /* that build at the same time; 0: one per core, at most one per program. PoCL builds one by one in a
     * process, so other processes build, at most 4 by default (docs/guide/devices.md, "Compiled programs") */
    uint32_t threads;
    const PelScatterWork* scatters; /* numScatters; nothing is written to their images */
    uint32_t numScatters;
} PelWarmUp;

/* Builds the programs that the described work will need, so that the first commit and the first execution do
 * not wait for them, and launches each kernel on nothing, since some drivers compile only then. If the driver
 * has a cache on disk, it keeps the result for later processes. Reports progress to the device's callback; if
 * that cancels, programs built so far are kept. `built`, if not NULL, receives the number of programs that
 * were not there before. Errors: PEL_ERROR_INVALID_ARGUMENT as from a shader's commit; PEL_ERROR_CANCELLED.
 */
PEL_API PelError pelWarmUpPrograms(PelDevice device, const PelWarmUp* work, uint32_t* built);

#include "pellucid_defaults.h"

#ifdef __cplusplus
}
#endif
#endif
