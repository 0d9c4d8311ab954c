// Every tolerance of the tests, with the reason for its size. No test holds a number of its own.
#pragma once
#include <array>

namespace tolerance {

// --- look-up tables, absolute, against the exact integral ---
// Gaussian sums have closed forms; a few float roundings of values near 1 remain
constexpr double lutTexelGaussians = 2e-6;
constexpr double oracleListing = 1e-9;  // 400,000 even steps over the kinks of max(cos, 0)
constexpr double lutTexelOther = 1e-5;  // profiles that need a quadrature on the device
// in 8-bit steps: truth this near to x.5 may round to either side
constexpr double lutRoundingBoundary = 1e-4;
constexpr double faceWorksBytes = 2;  // 8-bit steps: FaceWorks samples its integrals at 200 points
// relative; the mixtures of Gaussians that stand for burley and dipole leave 1e-6
constexpr double profileEvaluation = 3e-6;
constexpr double normalBlend = 0.05;  // of the factors 1, 0.3, 0 that were chosen by eye for skin
// 4000 logarithmic samples of a line spread, which burley's centre leaves short
constexpr double sampledEnergy = 1e-3;
constexpr double sixGaussians = 0.02;  // six Gaussians follow a dipole's line spread to about a percent
// a 64x64 root table from a quarter to a thousand radii, and 256 thicknesses, looked up bilinearly
constexpr double profileLookUp = 2e-3;
constexpr double transmissionSum = 1e-5;  // 20,000 midpoints; sums of Gaussians for the dipole
constexpr double unitRoundTrip = 1e-5;    // floats in one unit and another; the steepest row of a table
constexpr double closedEnds = 1e-5;       // a difference of texels over what lies between a row's ends
constexpr double floatWeights = 1e-6;     // weights and variances are written as floats
// a fit that has reached its optimum, by floats: weights of neighbours trade places
constexpr double fittedAgain = 1e-4;

// --- the surface integral, of the largest irradiance ---
// float sums round borders of triangles, which cancel; a table of 64 rows an octave
constexpr double surfaceNear = 3e-5;
// a measured profile that ends at a step: the rule along edges meets it between its points
constexpr double surfaceStep = 2e-4;
constexpr double surfaceFar = 1e-4;     // what a hierarchy of that tolerance may leave out
constexpr double surfaceSphere = 1e-4;  // a sphere of 200,000 facets against the closed form
constexpr double walkReflected = 3e-3;  // three standard errors of 200,000 photons
constexpr double walkErrors = 4.5;      // standard errors of a bin, of 60 bins
constexpr double walkTheirs = 5e-4;     // of the other walk, smoothed over N.L
constexpr double throughSlab = 0.015;   // light from beyond the profile's reach, in a slab of 12 paths
constexpr double slabReflects =
    0.01;  // over a half-space: twice 0.0025 of noise in 100,000 walks, 0.004 of the fit
// Over that of walks Burley's mean free path is 1.2 at a reflectance of 0.95, 0.86 at 0.5, 1.08 at 0.2.
constexpr double brightSlabReflects = 0.03, darkSlabReflects = 0.017;
constexpr double throughSlabPart = 0.03;  // relative: sums over blocks of texels
constexpr double publishedDeltaE = 1e-4;  // published to four decimals
constexpr double flip = 3e-5;        // the authors' program sums in floats, with more digits of sRGB's matrix
constexpr double neverWorse = 2e-4;  // of white: what the reference itself may be off on facets

// --- curvature, relative to the mesh's largest value ---
constexpr double edgeCurvature = 1e-5;  // differences of float positions and normals, then a mean per pass
// float least squares per triangle; slivers of irregular meshes lose three digits
constexpr double tensorCurvature = 1e-4;
// float normal equations of nine terms; 1e-5 on most meshes, 7e-5 where flipped edges leave slivers
constexpr double quadricCurvature = 3e-4;
// where flipped edges or noise leave rings so thin that a moment is held up, which depends on the axes; 3e-4
// elsewhere
constexpr double quadricTurned = 1e-2;
// relative: nearer to a threshold float may decide the other way; such vertices are not compared
constexpr double quadricDecision = 1e-4;
constexpr double torusExactNormals = 0.005;  // RMS, 20,000 vertices: what the estimators are chosen for
// RMS, the same with normals from the mesh, as hosts often have them
constexpr double torusEstimatedNormals = 0.01;
// RMS, 10,000 vertices: the flat side of an ellipsoid, next to the apex of a cone
constexpr double surfaceCurvature = 0.02;
// 1/length, a plane of side 4: rounding of positions over the square of an edge
constexpr double planeCurvature = 1e-5;
constexpr double orderQuadric = 1.8;          // second order, measured between two sizes
constexpr double orderTensor = 1.8;           // second order where errors of neighbours cancel
constexpr double orderTensorIrregular = 0.8;  // first order on irregular meshes
constexpr double heatKernel = 0.02;           // of the peak, at any distance and radius from two edges on
constexpr double heatMass = 1e-5;             // relative: float sums of hundreds of stages
// relative: rounding of hundreds of stages; means never leave the range
constexpr double diffusionRange = 1e-4;
// float angles and cross products; slivers of irregular meshes lose a digit
constexpr double normalComponent = 1e-5;
// largest relative error of the quadric fit, triangles up to 60 times longer than wide
constexpr double sliverSphere = 0.01;
// RMS, 20,000 vertices: twice what bent heights leave, half of what others would
constexpr double torusQuadric = 0.002;
// largest relative error of the quadric fit, cells up to 16 times longer than wide
constexpr double longCells = 0.005;
// of the local curvedness, RMS: the target for 20,000 scattered vertices; 0.02 to 0.15 % measured
constexpr double scatteredRms = 0.01;
constexpr double scatteredWorst = 0.1;  // the largest of them: what is wanted; 0.2 to 6 % measured
// largest, cells 1 : 25: float positions over the square of the shorter edge, 0.0039 at distance 4
constexpr double slenderTorus = 0.02;
// RMS, noise of 2 % of the edges, smoothed to three: what is left where the noise is as long
constexpr double noisySphere = 0.05;
// RMS, the same on surfaces that are flatter for their edges, whose borders spread by the radius
constexpr double noisySurface = 0.1;
constexpr double noisyBorder = 0.15;  // the same in the outermost two rows, whose two-rings lie on one side
// relative to 1/(a step): differences of float normals and positions of neighbours
constexpr double screenOracle = 2e-5;
constexpr double screenSphere = 2e-3;  // relative: float positions at steps of 1/30 radius; normals are exact
// relative: float depth leaves 1e-7 of the distance, a step is 1e-4 of it
constexpr double screenFromDepth = 0.02;
constexpr double shuffled = 2e-3;   // sums in another order; the fit squares the rounding of positions
constexpr double quantity = 2e-6;   // the same numbers combined in float and in double
constexpr double direction = 1e-5;  // unit length and right angles in float
// cosine: directions on an irregular mesh of 60 sides are off by a few degrees
constexpr double directionIrregular = 0.02;
// relative: float edge lengths; their logarithms add up without loss and errors average out
constexpr double uvScale = 2e-6;
constexpr double faceWorksUvScale = 1e-5;  // FaceWorks adds up logarithms in float

// --- shading, absolute per channel, from the same inputs and tables ---
constexpr double shadeTerm = 5e-5;  // one term alone: bilinear weights and a few dozen float operations
constexpr double shadeSum = 2e-4;   // all terms added and multiplied by light and albedo
// lights with a size, over the RMS of 1,024 small lights for each: what these leave of the integral
constexpr double areaDiffuse = 3e-4;
constexpr double areaTables = 0.05;  // by the size over the distance: two places of the table for all
// radius over distance up to 0.05, 0.3, 0.6, 4: nine points of the light for all of it
constexpr double areaHighlightSmall = 5e-4, areaHighlight = 0.012, areaHighlightLarge = 0.04,
                 areaHighlightWall = 0.1;
// share of light in a penumbra: the filter is rounder than a disk's edge response, and 32 taps find its width
constexpr double softShadow = 0.02;
// the same: texels of a cube's face lie elsewhere, so that other taps meet the edge
constexpr double softShadowInCube = 2e-3;
// relative: polynomials of degree 5 and 6 for 2^x
constexpr double fastMath = 4e-7;
// relative: squares of squares of such powers, and exponents near 60 in float
constexpr double slabDensity = 2e-5;
// relative: the tenth power of a float value read at float coordinates up to 300
constexpr double specularTable = 2e-4;
// length: depths of a map that spans 200 to 700, through one float division
constexpr double shadeThickness = 2e-3;
constexpr double ggxEnergy = 3e-3;   // against a mean of 100,000 random half vectors
constexpr double diskMoment = 0.02;  // mean squared radius of a disk, 1/2, from 8 points
constexpr double diskEdge = 0.55;    // RMS error over straight edges, relative to as many random points
constexpr double faceWorksTapsMean = 0.002;  // relative: means over 20,000 pixels, other taps
constexpr double faceWorksTapsRms = 0.08;    // of the mean: pixel by pixel with 8 other taps
// float UV times map size: 1e-5 of a texel between random normals; levels by float log2
constexpr double mappedNormal = 2e-4;
// the kernel's polynomial for the weights is 5e-5 off; float sums over a thousand texels
constexpr double wideShadow = 2e-4;
// texels of 1/80 of the filter: where the edge falls between two of them
constexpr double wideShadowEdge = 0.01;
// RMS of interpolated wide shadows: each is at most 5e-3 from the mean of its neighbours
constexpr double betweenShadowRms = 1.5e-3;
// share of pixels more than a hundredth off: where shadows are narrower than two pixels
constexpr double betweenShadowShare = 2e-3;
// RMS of thickness by cells in other units: depths of 150 are rounded by 1e-5, near edges more
constexpr double cellsScaled = 2e-3;
// variance is a difference of float squares: 1e-7 of z^2 is 0.1 mm in a map 300 mm deep
constexpr double contentShadow = 2e-3;
// mm: between texels whose exponentials differ 10,000 times a float weight near 0 or 1 shows
constexpr double contentThickness = 0.02;
// mm in a map 300 mm deep: float depths of 1e-7, and where a tap falls between texels
constexpr double mapThickness = 1e-3;
// mm at 100 mm from the light: float depths with a near plane at 5 mm leave 2e-3 each
constexpr double cubeThickness = 0.01;
// mean over pixels: exp(-c dz) where 50 mm are a tenth of a radial map's range; a hundredth at twice the
// distance
constexpr double contentInCube = 0.04;
// mm, and 2 % of the thickness: depths of neighbours are weighed as exponentials, not as they are
constexpr double contentInCubeThickness = 0.05;
constexpr double faceWorksTerm = 1e-6;       // FaceWorks' float arithmetic and float LUT coordinates
constexpr double faceWorksSharpened = 1e-6;  // the same, steeper by the sharpening
// positions from float depth: 1e-7 of depth moves a point by 1e-3 of the frame's 200, and thickness with it
constexpr double shadeFromDepth = 1e-3;

// --- the oracle against itself (double precision, two methods) ---
constexpr double sampledSphere = 1e-3;  // averages over 20,000 even directions
constexpr double oracleExact = 1e-13;   // the same sum in another order of operations

// --- the sample renderer, against analytic surfaces; lengths in mm on a sphere of radius 50 ---
constexpr double samplePosition = 1e-4;  // mm: float vertices and images at coordinates up to 300
// mm: half an ulp of float depth near 1, between planes at 100 and 2000
constexpr double sampleFromDepth = 0.02;
// the ray meets a facet, whose interpolated normal is the sphere's to 2nd order
constexpr double sampleFacetNormal = 1e-4;
constexpr double sampleUnit = 1e-6;         // float rounding of values up to 1
constexpr double samplePixel = 1e-4;        // pixels: float rounding of a position, projected
constexpr double sampleMatrix = 1e-9;       // double-precision matrices and closed forms
constexpr double litSphere = 1e-3;          // area and flux of a sphere's facets: 100 rings leave 6e-4
constexpr double sampleRandomField = 0.15;  // relative: a sum of 100 waves over a few hundred wavelengths
constexpr double sampleAlbedoMean = 0.03;   // the mean of few, wide random blotches
constexpr double sampleWaves = 1e-4;        // single-precision sines with phases up to 100

// --- between two programs of one result on a GPU, whose compiler contracts each in its own way ---
constexpr double otherProgram = 2e-6;  // relative above 1; an H200: 1e-6. On CPUs they have the same bits

// --- what the search of bench/stability may find beyond the ranges of the tests ---
constexpr double stretchedNormals = 5e-5;  // as normalComponent, triangles 50 times longer than wide
// of the largest: normals of neighbours differ by 1/300, float leaves 1e-7 of each
constexpr double finePixels = 1e-4;
// of the largest, against the flow itself: what a series of 4 to 64 stages leaves of it
constexpr double radiusSmoothing = 1.5e-3;
// as wideShadow, bias 0.1 mm and softness 0.1 of filters of 1 mm: float depth of 1e-7 is 4e-5 mm of that 0.1
// mm
constexpr double wideShadowAnywhere = 5e-4;
constexpr double decodedImage = 2e-6;  // radiance up to 1 from decoded values: a few float roundings

// --- pictures that Blender rendered ---
// RMS: some dozen pixels where a shadow's edge crosses the pixel centre differ
constexpr double blenderLambert = 5e-4;
// RMS against Cycles, which fades smooth normals out at grazing light
constexpr double blenderScriptLambert = 5e-4;
// spherical harmonics from 64 x 32 pixels of Blender's sky, 16 jittered samples each
constexpr double blenderSky = 1e-3;
// relative: a subdivided and smoothed ball of 48 x 24 faces is not quite a sphere
constexpr double blenderCurvature = 0.03;
// times Lambert's error in red: what the path tracer's noise leaves room for
constexpr double blenderTerminator = 0.5;

// --- scattering on the screen ---
// blocks stand for their pixels; and the slope, which plain means lack: 4.9e-3 measured
constexpr double scatterBlocksRms = 5.3e-3;
// the same over stripes of shadow, and with a radius of 1.5 times the profile's
constexpr double radiusPerPixelRms = 1.1e-2;
constexpr double scatterBlocksMax = 8.5e-2;  // the same, where the edge of a hard shadow meets the limb
constexpr double scatterOneMissing = 2e-2;   // neighbours of a pixel that counts no more
constexpr double widthsAgree = 1e-3;         // between widths of vectors: the order of sums
constexpr double oneLaneAgrees = 1e-4;       // the same for the kept frames, 7e-6 measured
// RMS, a tenth of the maximum: a ring of blocks with 0.4 % of the light may count or not
constexpr double scatterUnits = 1e-3;
// of the pixels of a front-lit head, at least: 0.22 of skin and 0.26 of a narrow profile measured. Of its
// tiles 0.33 and 0.47 could be left alone, of its pixels 0.61 and 0.74
constexpr double keptOfHead = 0.2;
constexpr double costOfTenth = 0.125;  // of the whole: tiles and blocks that are covered in part count whole
// relative, RMS, far wider than the ball: a 256th of it lies beyond the profile's table, whose nodes end a
// little further out
constexpr double lightFlux = 5e-3;
constexpr double lightPlaces = 0.024;  // as wide as the ball: blocks of texels half as wide as their distance
constexpr double lightTails = 0.04;    // the same in the tails of narrow Gaussians
// relative, RMS, on a ball narrower than the profile's radius: hidden weight is known if either light shows
// it, and bounds on what a slope takes away do not add up; 0.016 measured, 0.001 on one five times wider
constexpr double lightsAddUp = 2e-2;
// of targetError, the worst pixel of several bodies: second differences measure, they do not bound; 1.45
// measured
constexpr double scatterLeftOut = 1.6;
// of those at the default, with ten times its error: 0.70 to 0.77 measured
constexpr double tapsOfLargeError = 0.85;
// of white, sums of many pixels' differences over the root of their number: at most 1.6e-6 between 1, 8 and
// 16 lanes, whose order of additions differs
constexpr double keptResults = 1e-5;
// relative, counts of tiles, pixels, taps: between machines of as many lanes only steps at a threshold differ
constexpr double keptWork = 0.02;
constexpr double keptCurvature = 1e-5;  // of the same, 1/length, of meshes of a few units
constexpr double keptHead = 1e-5;       // the same of lengths, mm; a hundred times for places in float32
constexpr double keptPixels = 3e-3;     // of white, means of 4 x 4 pixels: one that shows something else
constexpr double scatterLanes = 2e-6;   // of white, one lane beside sixteen: order of additions
constexpr double scatterSeam = 1.6;     // the same, over the borders of tiles that took different ways
// of targetError: how much more a tile steps that begins to count; 0.03 measured
constexpr double scatterFade = 0.1;
// of white, in a dark gap: 0.006 in one pixel that few blocks round it are the same surface as
constexpr double scatterBluer = 0.01;
constexpr double scatterWideRms = 1.4e-2;  // a Gaussian of 96 pixels against its closed form; 1.2e-2 measured
// the same at the worst pixel, at the picture's border; 4.5e-2 measured
constexpr double scatterWideMost = 5e-2;
// relative, RMS: in the tails of Gaussians alone, blocks of texels half as wide as their distance are 10 %
// off
constexpr double lightThroughBall = 0.12;
// the same for blocks of 2 x 2 of 24 x 24 pixels, and as far as the screen lacks weight: 0.14 to 0.19
// measured
constexpr double hiddenThroughBall = 0.2;
// of red: 2 x 2 pixels at the edge of a strip of eight; 0.16 measured, 0.02 in its middle
constexpr double throughSheet = 0.18;
constexpr double lightSeenTwice = 4e-3;  // two ways to divide a sum by its weights

// --- against the surface integral of a head, RMSE in 1e-4 of radiance, albedo 0.8 ---
inline constexpr std::array headOnScreen{40.0, 14.0, 9.0};  // Lambert with ray-traced shadows: 85, 30, 14
// screen and maps; 25.0 measured, 31 without; 11.4 measured; 8.5 measured
inline constexpr std::array lightHead{28.0, 12.8, 9.0};
// 102 measured; Lambert 324, 123 without a map; 65 measured; Lambert 161, 68 without; 49 measured; Lambert 99
inline constexpr std::array lightFour{106.0, 67.0, 52.0};
constexpr double gain = 6e-3;  // curvature by differences of float positions over a window
// against random walks: 58; 84 without directions and gain; 42; 49 without; 49; 49 without
constexpr double parallelView = 1e-3;  // a ball of 12 at a distance of 4000 is seen 0.003 to the side
constexpr double walkBalls[] = {123, 65, 54, 36, 19, 12};  // 1e-4 of white: 5 % above 117, 62, 52, 34, 17, 10
constexpr double walkHead[3] = {61, 45, 51};
// against random walks: 178; 212 without directions and gain; 75; 107 without; 50; 69 without
constexpr double walkHeadTimesFour[3] = {187, 79, 54};
// 6.1, 1.6 and 0.6 measured; Lambert 42, 8.7, 3.1
inline constexpr std::array lightBall{7.0, 2.0, 1.3};
// scattering `light`; 6.7 measured; 5.6 measured; 5.2 measured: triangles lean from the ball by up to 0.026
inline constexpr std::array lightBallOfLight{8.0, 6.5, 6.0};
// scattering `light`; 14.1 measured; 8.7 measured; 7.9 measured
inline constexpr std::array lightHeadOfLight{16.0, 9.7, 8.7};
inline constexpr std::array lightFourOfLight{36.0, 45.0, 44.0};  // 31 measured; 40 measured; 40 measured
constexpr double headByMapBlue = 23;  // irradiance alone, from texels of 0.33 mm: 22
// taps that round to another pixel, where the profile's table ends a node further out
constexpr double scatterTapsRms = 2e-3;
constexpr double scatterTapsMost = 4e-2;  // the same, of the worst pixel
constexpr double scatterHalfRate = 2e-2;  // a pattern of single pixels, of 0.6 in the mean, between samples
// the share of light from within a pixel is interpolated in a table: 4e-6 and 8e-5 measured
constexpr double historyRms = 1e-5;
constexpr double historyMost = 2e-4;
constexpr double textureDensities = 1.2e-2;  // a sample stands for the texels up to halfway to the next
constexpr double texturePlane = 4.5e-3;      // the narrowest Gaussians are below a texel there
constexpr double textureSphere = 1.3e-3;     // texels along u and v stand for distances
// depths are floats over 300 texels' lengths; differences of them count three times
constexpr double sharpShadow = 2e-3;

// --- memory ---
constexpr double heldMemory = 0.05;  // tables of profiles and lists of a few hundred bytes are not counted

// --- environment ---
// nodes of 8 x 8 a face, between which irradiance is linear, and texels of 16 x 16
constexpr double environmentAmbient = 5e-3;
// relative RMS, 0.04 to 0.1 measured: lobes are round, as if they were seen along the normal
constexpr double environmentSpecular = 0.12;
// 0.029 measured, of a texel of 0.3 degrees: three samples along two texels, turned against them
constexpr double environmentLamp = 0.035;
constexpr double environmentShare = 2e-3;  // 512 samples, and linear between 32 x 32 nodes

// --- eyes ---
// RMS, of the table's mean; 0.7 % measured, of which the photons' noise is half
constexpr double eyeLutRms = 1e-2;
constexpr double eyeLutFlux = 1e-3;       // flux on the texels, relative
constexpr double eyeLutScattered = 2e-4;  // means over texels by 8 x 8 points in both
constexpr double eyePictureRms = 2e-3;    // RMS of an eye's pixels, white is 1: refraction, gloss
constexpr double eyeCausticRms = 1e-2;    // the same, with caustics from a table of 64 x 64 x 32
// RMS of an iris against one that is evenly grey: neighbouring levels differ by this
constexpr double eyeMinified = 0.05;

// Skin against random walks: the grid of depths and directions is right to 0.003, the table between its nodes
// to 0.002. The oracle of albedos sums in other steps.
constexpr double skinReflectance = 0.01, skinAlbedo = 0.01;
// The oracle has approximate matching functions every 10 nm; its noise is 1 to 2 % of the distance.
constexpr double skinDistance = 0.05;
constexpr double skinProfile = 0.01;   // 14 Gaussians against light that falls like 1/d near its entry
constexpr double skinRoundTrip = 0.5;  // CIEDE2000; a fraction of what can be seen
// CIEDE2000; the search stops at 0.005, and without oxygen blood and melanin are nearly alike
constexpr double skinSearch = 0.06;
constexpr double skinMeasured = 3;  // CIEDE2000; other observers, instruments and people
}  // namespace tolerance
