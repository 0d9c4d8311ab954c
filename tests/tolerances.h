// Every tolerance of the tests, with the reason for its size. No test holds a number of its own.
// Use: EXPECT_NEAR(a, b, tolerance::lutTexel) - an entry converts to its value.
#pragma once

namespace tolerance {

struct Tolerance {
    const char* name;
    double value;
    const char* reason;
    constexpr operator double() const { return value; }
};

// --- look-up tables, absolute, against the exact integral ---
inline constexpr Tolerance lutTexel{"lutTexel", 1e-5, "any float LUT texel: well below half a 10-bit step"};
inline constexpr Tolerance lutTexelGaussians{
    "lutTexelGaussians", 2e-6,
    "Gaussian sums have closed forms; a few float roundings of values near 1 remain"};
inline constexpr Tolerance oracleListing{"oracleListing", 1e-9,
                                         "400,000 even steps over the kinks of max(cos, 0)"};
inline constexpr Tolerance lutTexelOther{"lutTexelOther", 1e-5,
                                         "profiles that need a quadrature on the device"};
inline constexpr Tolerance lutRoundingBoundary{
    "lutRoundingBoundary", 1e-4, "in 8-bit steps: truth this near to x.5 may round to either side"};
inline constexpr Tolerance faceWorksBytes{"faceWorksBytes", 2,
                                          "8-bit steps: FaceWorks samples its integrals at 200 points"};
inline constexpr Tolerance profileEvaluation{
    "profileEvaluation", 3e-6,
    "relative; the mixtures of Gaussians that stand for burley and dipole leave 1e-6"};
inline constexpr Tolerance normalBlend{"normalBlend", 0.05,
                                       "of the factors 1, 0.3, 0 that were chosen by eye for skin"};
inline constexpr Tolerance sampledEnergy{
    "sampledEnergy", 1e-3, "4000 logarithmic samples of a line spread, which burley's centre leaves short"};
inline constexpr Tolerance sixGaussians{"sixGaussians", 0.02,
                                        "six Gaussians follow a dipole's line spread to about a percent"};
inline constexpr Tolerance profileLookUp{
    "profileLookUp", 2e-3,
    "a 64x64 root table from a quarter to a thousand radii, and 256 thicknesses, looked up bilinearly"};
inline constexpr Tolerance transmissionSum{"transmissionSum", 1e-5,
                                           "20,000 midpoints; sums of Gaussians for the dipole"};
inline constexpr Tolerance unitRoundTrip{"unitRoundTrip", 1e-5,
                                         "floats in one unit and another; the steepest row of a table"};
inline constexpr Tolerance closedEnds{"closedEnds", 1e-5,
                                      "a difference of texels over what lies between a row's ends"};
inline constexpr Tolerance floatWeights{"floatWeights", 1e-6, "weights and variances are written as floats"};
inline constexpr Tolerance fittedAgain{
    "fittedAgain", 1e-4, "a fit that has reached its optimum, by floats: weights of neighbours trade places"};
inline constexpr Tolerance sphereMean{"sphereMean", 1e-5,
                                      "energy: the mean of the form sphere is exactly 1/4"};

// --- the surface integral, of the largest irradiance ---
inline constexpr Tolerance surfaceNear{
    "surfaceNear", 3e-5, "float sums round borders of triangles, which cancel; a table of 64 rows an octave"};
inline constexpr Tolerance surfaceStep{
    "surfaceStep", 2e-4,
    "a measured profile that ends at a step: the rule along edges meets it between its points"};
inline constexpr Tolerance surfaceFar{"surfaceFar", 1e-4, "what a hierarchy of that tolerance may leave out"};
inline constexpr Tolerance surfaceSphere{"surfaceSphere", 1e-4,
                                         "a sphere of 200,000 facets against the closed form"};

inline constexpr Tolerance walkReflected{"walkReflected", 3e-3, "three standard errors of 200,000 photons"};
inline constexpr Tolerance walkErrors{"walkErrors", 4.5, "standard errors of a bin, of 60 bins"};
inline constexpr Tolerance walkTheirs{"walkTheirs", 5e-4, "of the other walk, smoothed over N.L"};

inline constexpr Tolerance publishedDeltaE{"publishedDeltaE", 1e-4, "published to four decimals"};

inline constexpr Tolerance litFacets{
    "litFacets", 0.02, "a cosine from interpolated normals, at a point of a facet beside that of the ball"};
inline constexpr Tolerance referenceRms{"referenceRms", 1e-3,
                                        "RMS on a ball of 57,600 facets at pixels that were brought to it"};

inline constexpr Tolerance neverWorse{"neverWorse", 2e-4,
                                      "of white: what the reference itself may be off on facets"};

// --- curvature, relative to the mesh's largest value ---
inline constexpr Tolerance edgeCurvature{"edgeCurvature", 1e-5,
                                         "differences of float positions and normals, then a mean per pass"};
inline constexpr Tolerance tensorCurvature{
    "tensorCurvature", 1e-4,
    "float least squares per triangle; slivers of irregular meshes lose three digits"};
inline constexpr Tolerance quadricCurvature{
    "quadricCurvature", 3e-4,
    "float normal equations of nine terms; 1e-5 on most meshes, 7e-5 where flipped edges leave slivers"};
inline constexpr Tolerance quadricTurned{"quadricTurned", 1e-2,
                                         "where flipped edges or noise leave rings so thin that a moment is "
                                         "held up, which depends on the axes; 3e-4 elsewhere"};
inline constexpr Tolerance quadricDecision{
    "quadricDecision", 1e-4,
    "relative: nearer to a threshold float may decide the other way; such vertices are not compared"};
inline constexpr Tolerance torusExactNormals{"torusExactNormals", 0.005,
                                             "RMS, 20,000 vertices: what the estimators are chosen for"};
inline constexpr Tolerance torusEstimatedNormals{
    "torusEstimatedNormals", 0.01, "RMS, the same with normals from the mesh, as hosts often have them"};
inline constexpr Tolerance surfaceCurvature{
    "surfaceCurvature", 0.02,
    "RMS, 10,000 vertices: the flat side of an ellipsoid, next to the apex of a cone"};
inline constexpr Tolerance planeCurvature{
    "planeCurvature", 1e-5, "1/length, a plane of side 4: rounding of positions over the square of an edge"};
inline constexpr Tolerance orderQuadric{"orderQuadric", 1.8, "second order, measured between two sizes"};
inline constexpr Tolerance orderTensor{"orderTensor", 1.8, "second order where errors of neighbours cancel"};
inline constexpr Tolerance orderTensorIrregular{"orderTensorIrregular", 0.8,
                                                "first order on irregular meshes"};
inline constexpr Tolerance heatKernel{"heatKernel", 0.02,
                                      "of the peak, at any distance and radius from two edges on"};
inline constexpr Tolerance heatSpread{
    "heatSpread", 0.02,
    "radius that a point reaches in a lattice moved by .4 of an edge; half of what its variance is off"};
inline constexpr Tolerance heatMass{"heatMass", 1e-5, "relative: float sums of hundreds of stages"};
inline constexpr Tolerance heatHarmonic{"heatHarmonic", 0.01,
                                        "relative, the eighth, of which 0.039 is left: 0.0083 on 2,562 "
                                        "vertices, less on more: stages leave out 2e-4"};
inline constexpr Tolerance diffusionRange{
    "diffusionRange", 1e-4, "relative: rounding of hundreds of stages; means never leave the range"};
inline constexpr Tolerance normalComponent{
    "normalComponent", 1e-5, "float angles and cross products; slivers of irregular meshes lose a digit"};
inline constexpr Tolerance sliverSphere{
    "sliverSphere", 0.01,
    "largest relative error of the quadric fit, triangles up to 60 times longer than wide"};
inline constexpr Tolerance torusQuadric{
    "torusQuadric", 0.002, "RMS, 20,000 vertices: twice what bent heights leave, half of what others would"};
inline constexpr Tolerance longCells{
    "longCells", 0.005, "largest relative error of the quadric fit, cells up to 16 times longer than wide"};
inline constexpr Tolerance scatteredRms{
    "scatteredRms", 0.01,
    "of the local curvedness, RMS: what is wanted of 20,000 scattered vertices; 0.02 to 0.15 % measured"};
inline constexpr Tolerance scatteredWorst{"scatteredWorst", 0.1,
                                          "the largest of them: what is wanted; 0.2 to 6 % measured"};
inline constexpr Tolerance scatteredPassesRms{
    "scatteredPassesRms", 0.012,
    "RMS after the two default passes, against the surface: 0.001 to 0.96 % measured"};
inline constexpr Tolerance scatteredPassesWorst{"scatteredPassesWorst", 0.08,
                                                "the largest of them: 0.006 to 6.1 % measured"};
inline constexpr Tolerance slenderTorus{
    "slenderTorus", 0.02,
    "largest, cells 1 : 25: float positions over the square of the shorter edge, 0.0039 at distance 4"};
inline constexpr Tolerance tiltedNormals{"tiltedNormals", 0.01,
                                         "RMS, torus of 13,000 vertices whose normals are off by 10 degrees"};
inline constexpr Tolerance foldedNormals{"foldedNormals", 0.004,
                                         "RMS, 10,000 vertices: hardly more than with exact normals"};
inline constexpr Tolerance replacedNormal{
    "replacedNormal", 0.02, "1/length, curvatures up to 1: another frame of the same fit, 5 degrees off"};
inline constexpr Tolerance noisySphere{
    "noisySphere", 0.05,
    "RMS, noise of 2 % of the edges, smoothed to three: what is left where the noise is as long"};
inline constexpr Tolerance noisySurface{
    "noisySurface", 0.1,
    "RMS, the same on surfaces that are flatter for their edges, whose borders spread by the radius"};
inline constexpr Tolerance noisyBorder{"noisyBorder", 0.15,
                                       "the same in the outermost two rows, whose two-rings lie on one side"};
inline constexpr Tolerance screenOracle{
    "screenOracle", 2e-5, "relative to 1/(a step): differences of float normals and positions of neighbours"};
inline constexpr Tolerance screenSphere{
    "screenSphere", 2e-3, "relative: float positions at steps of 1/30 radius; normals are exact"};
inline constexpr Tolerance screenShaded{
    "screenShaded", 1e-3, "radiance up to 1: what an error of screenSphere in curvature may do to it"};
inline constexpr Tolerance screenFromDepth{
    "screenFromDepth", 0.02, "relative: float depth leaves 1e-7 of the distance, a step is 1e-4 of it"};
inline constexpr Tolerance shuffled{"shuffled", 2e-3,
                                    "sums in another order; the fit squares the rounding of positions"};
inline constexpr Tolerance quantity{"quantity", 2e-6, "the same numbers combined in float and in double"};
inline constexpr Tolerance direction{"direction", 1e-5, "unit length and right angles in float"};
inline constexpr Tolerance directionIrregular{
    "directionIrregular", 0.02,
    "cosine: directions on an irregular mesh of 60 sides are off by a few degrees"};
inline constexpr Tolerance uvScale{
    "uvScale", 2e-6,
    "relative: float edge lengths; their logarithms add up without loss and errors average out"};

inline constexpr Tolerance faceWorksUvScale{"faceWorksUvScale", 1e-5,
                                            "FaceWorks adds up logarithms in float"};
inline constexpr Tolerance finiteDifference{"finiteDifference", 2e-6, "second differences at a step of 1e-4"};
inline constexpr Tolerance countedArea{"countedArea", 5e-3, "areas by counting 400² points"};

// --- shading, absolute per channel, from the same inputs and tables ---
inline constexpr Tolerance shadeTerm{"shadeTerm", 5e-5,
                                     "one term alone: bilinear weights and a few dozen float operations"};
inline constexpr Tolerance shadeSum{"shadeSum", 2e-4, "all terms added and multiplied by light and albedo"};

inline constexpr Tolerance cubeOfHarmonics{
    "cubeOfHarmonics", 6e-4,
    "32 texels along an edge: bilinear between directions up to 3.6 degrees apart, 3.5e-4 measured"};
inline constexpr Tolerance specularTable{
    "specularTable", 2e-4, "relative: the tenth power of a float value read at float coordinates up to 300"};
inline constexpr Tolerance shadeThickness{
    "shadeThickness", 2e-3, "length: depths of a map that spans 200 to 700, through one float division"};
inline constexpr Tolerance ggxEnergy{"ggxEnergy", 3e-3, "against a mean of 100,000 random half vectors"};
inline constexpr Tolerance diskMoment{"diskMoment", 0.02,
                                      "mean squared radius of a disk, 1/2, from 8 points"};
inline constexpr Tolerance diskSpacing{
    "diskSpacing", 0.65,
    "least distance over that of a hexagonal packing: 0.7 to 0.75 is called blue noise, 0 is white"};
inline constexpr Tolerance diskEdge{"diskEdge", 0.55,
                                    "RMS error over straight edges, relative to as many random points"};
inline constexpr Tolerance faceWorksTapsMean{"faceWorksTapsMean", 0.002,
                                             "relative: means over 20,000 pixels, other taps"};
inline constexpr Tolerance faceWorksTapsRms{"faceWorksTapsRms", 0.08,
                                            "of the mean: pixel by pixel with 8 other taps"};
inline constexpr Tolerance blurResponse{
    "blurResponse", 0.02, "share of a wave that is left: 13 taps stand for an integral over the kernel"};
inline constexpr Tolerance mappedNormal{
    "mappedNormal", 2e-4,
    "float UV times map size: 1e-5 of a texel between random normals; levels by float log2"};
inline constexpr Tolerance wideShadow{
    "wideShadow", 2e-4,
    "the kernel's polynomial for the weights is 5e-5 off; float sums over a thousand texels"};
inline constexpr Tolerance wideShadowEdge{
    "wideShadowEdge", 0.01, "texels of 1/80 of the filter: where the edge falls between two of them"};
inline constexpr Tolerance betweenShadowRms{
    "betweenShadowRms", 1.5e-3,
    "RMS of interpolated wide shadows: each is at most 5e-3 from the mean of its neighbours"};
inline constexpr Tolerance betweenShadowShare{
    "betweenShadowShare", 2e-3,
    "share of pixels more than a hundredth off: where shadows are narrower than two pixels"};
inline constexpr Tolerance cellsOfPlane{"cellsOfPlane", 0.03,
                                        "RMS of thickness by cells of a plane that falls by 0.1 a texel: "
                                        "samples lie up to a sixteenth of the radius off their taps"};
inline constexpr Tolerance cellsScaled{
    "cellsScaled", 2e-3,
    "RMS of thickness by cells in other units: depths of 150 are rounded by 1e-5, near edges more"};
inline constexpr Tolerance contentShadow{
    "contentShadow", 2e-3,
    "variance is a difference of float squares: 1e-7 of z^2 is 0.1 mm in a map 300 mm deep"};
inline constexpr Tolerance contentThickness{
    "contentThickness", 0.02,
    "mm: between texels whose exponentials differ 10,000 times a float weight near 0 or 1 shows"};
inline constexpr Tolerance mapThickness{
    "mapThickness", 1e-3,
    "mm in a map 300 mm deep: float depths of 1e-7, and where a tap falls between texels"};
inline constexpr Tolerance cubeThickness{
    "cubeThickness", 0.01,
    "mm at 100 mm from the light: float depths with a near plane at 5 mm leave 2e-3 each"};
inline constexpr Tolerance contentInCube{"contentInCube", 0.04,
                                         "mean over pixels: exp(-c dz) where 50 mm are a tenth of a radial "
                                         "map's range; a hundredth at twice the distance"};
inline constexpr Tolerance contentInCubeThickness{
    "contentInCubeThickness", 0.05,
    "mm, and 2 % of the thickness: depths of neighbours are weighed as exponentials, not as they are"};
inline constexpr Tolerance cubeTurnedThickness{
    "cubeTurnedThickness", 0.1, "mm, mean over pixels: disks of 32 taps that lie elsewhere on the map"};
inline constexpr Tolerance cubeTurned{"cubeTurned", 0.03,
                                      "filters of 16 texels across that lie elsewhere on the map"};
inline constexpr Tolerance faceWorksTerm{"faceWorksTerm", 1e-6,
                                         "FaceWorks' float arithmetic and float LUT coordinates"};
inline constexpr Tolerance faceWorksSharpened{"faceWorksSharpened", 1e-6,
                                              "the same, steeper by the sharpening"};

inline constexpr Tolerance shadeFromDepth{"shadeFromDepth", 1e-3,
                                          "positions from float depth: 1e-7 of depth moves a point by 1e-3 "
                                          "of the frame's 200, and thickness with it"};

// --- the oracle against itself (double precision, two methods) ---
inline constexpr Tolerance oracleQuadrature{"oracleQuadrature", 1e-11,
                                            "two adaptive quadratures of one integral, each asked for 1e-13"};
inline constexpr Tolerance oracleLineSpread{"oracleLineSpread", 1e-11,
                                            "relative: line spread by quadrature against a closed form"};
inline constexpr Tolerance oracleEnergy{"oracleEnergy", 1e-11, "profiles integrate to 1"};
inline constexpr Tolerance oracleClosedForm{
    "oracleClosedForm", 1e-10, "quadrature against Bessel, Fourier or erf closed form, series cut at 1e-14"};
inline constexpr Tolerance oracleSingular{
    "oracleSingular", 1e-8, "as oracleQuadrature, where the second method meets a logarithm unprepared"};
inline constexpr Tolerance flatLimit{
    "flatLimit", 5e-5, "at r = 1e4 sigma scattering moves light by sigma/r next to the terminator"};
inline constexpr Tolerance smallRadiusLimit{"smallRadiusLimit", 1e-7,
                                            "at r = 1e-4 sigma the first mode is r²/2 sigma²"};
inline constexpr Tolerance srgbInverse{"srgbInverse", 1e-6, "the standard's two pieces meet to seven digits"};
inline constexpr Tolerance sampledSphere{"sampledSphere", 1e-3, "averages over 20,000 even directions"};
inline constexpr Tolerance oracleExact{"oracleExact", 1e-13, "the same sum in another order of operations"};
inline constexpr Tolerance publishedWidth{"publishedWidth", 6e-4,
                                          "mm: the published sigmas are rounded to three digits"};
inline constexpr Tolerance publishedWeights{"publishedWeights", 1e-12,
                                            "the published weights add up to 1 in each channel"};

// --- the sample renderer, against analytic surfaces; lengths in mm on a sphere of radius 50 ---
inline constexpr Tolerance samplePosition{"samplePosition", 1e-4,
                                          "mm: float vertices and images at coordinates up to 300"};
inline constexpr Tolerance sampleFromDepth{
    "sampleFromDepth", 0.02, "mm: half an ulp of float depth near 1, between planes at 100 and 2000"};
inline constexpr Tolerance sampleFacetNormal{
    "sampleFacetNormal", 1e-4,
    "the ray meets a facet, whose interpolated normal is the sphere's to 2nd order"};
inline constexpr Tolerance sampleUnit{"sampleUnit", 1e-6, "float rounding of values up to 1"};
inline constexpr Tolerance samplePixel{"samplePixel", 1e-4,
                                       "pixels: float rounding of a position, projected"};
inline constexpr Tolerance sampleMatrix{"sampleMatrix", 1e-9, "double-precision matrices and closed forms"};
inline constexpr Tolerance sampleDerivative{"sampleDerivative", 1e-6,
                                            "relative: a central difference of step 1e-5"};
inline constexpr Tolerance litSphere{"litSphere", 1e-3,
                                     "area and flux of a sphere's facets: 100 rings leave 6e-4"};
inline constexpr Tolerance sampleRandomField{"sampleRandomField", 0.15,
                                             "relative: a sum of 100 waves over a few hundred wavelengths"};
inline constexpr Tolerance sampleMeanSquare{"sampleMeanSquare", 0.03,
                                            "the mean over 20000 points of a random field"};
inline constexpr Tolerance sampleAlbedoMean{"sampleAlbedoMean", 0.03,
                                            "the mean of few, wide random blotches"};
inline constexpr Tolerance sampleWaves{"sampleWaves", 1e-4, "single-precision sines with phases up to 100"};
inline constexpr Tolerance sampleQuadrature{"sampleQuadrature", 1e-5,
                                            "a midpoint rule of 4000 steps over a square root's end"};
inline constexpr Tolerance sampleWideShadow{
    "sampleWideShadow", 0.003, "texels of 1/200 of the filter: where the edge falls between two of them"};
inline constexpr Tolerance sampleSky{"sampleSky", 0.02,
                                     "what orders above 2 carry of a sky with a soft lamp"};

// --- what the search of bench/stability may find beyond the ranges of the tests ---
inline constexpr Tolerance stretchedNormals{"stretchedNormals", 5e-5,
                                            "as normalComponent, triangles 50 times longer than wide"};
inline constexpr Tolerance finePixels{
    "finePixels", 1e-4, "of the largest: normals of neighbours differ by 1/300, float leaves 1e-7 of each"};
inline constexpr Tolerance radiusSmoothing{
    "radiusSmoothing", 1.5e-3,
    "of the largest, against the flow itself: what a series of 4 to 64 stages leaves of it"};
inline constexpr Tolerance wideShadowAnywhere{"wideShadowAnywhere", 5e-4,
                                              "as wideShadow, bias 0.1 mm and softness 0.1 of filters of 1 "
                                              "mm: float depth of 1e-7 is 4e-5 mm of that 0.1 mm"};
inline constexpr Tolerance decodedImage{"decodedImage", 2e-6,
                                        "radiance up to 1 from decoded values: a few float roundings"};

// --- a real host's pictures ---
inline constexpr Tolerance realHostLambert{
    "realHostLambert", 2e-4,
    "root mean square: 9e-5 on the head from pixels at shadow edges, where the host traced another ray"};
// --- pictures that Blender rendered ---
inline constexpr Tolerance blenderLambert{
    "blenderLambert", 5e-4, "RMS: some dozen pixels where a shadow's edge crosses the pixel centre differ"};
inline constexpr Tolerance blenderScriptLambert{
    "blenderScriptLambert", 5e-4, "RMS against Cycles, which fades smooth normals out at grazing light"};
inline constexpr Tolerance blenderSky{
    "blenderSky", 1e-3, "spherical harmonics from 64 x 32 pixels of Blender's sky, 16 jittered samples each"};
inline constexpr Tolerance blenderCurvature{
    "blenderCurvature", 0.03,
    "relative: a subdivided and smoothed ball of 48 x 24 faces is not quite a sphere"};
inline constexpr Tolerance blenderTerminator{
    "blenderTerminator", 0.5, "times Lambert's error in red: what the path tracer's noise leaves room for"};

inline constexpr Tolerance blenderCurve{
    "blenderCurve", 0.25,
    "times Lambert's error, of means over equal N.L: the path tracer's noise left in means of 1,000 pixels"};

// --- scattering on the screen ---
inline constexpr Tolerance scatterBlocksRms{
    "scatterBlocksRms", 5.3e-3,
    "blocks stand for their pixels; and the slope, which plain means lack: 4.9e-3 measured"};
inline constexpr Tolerance scatterBlocksMax{"scatterBlocksMax", 8.5e-2,
                                            "the same, where the edge of a hard shadow meets the limb"};
inline constexpr Tolerance scatterBall{"scatterBall", 1.3e-3,
                                       "RMS against the closed form, in units of white"};
inline constexpr Tolerance scatterEnergy{"scatterEnergy", 5e-3, "relative: blocks, and what is left out"};
inline constexpr Tolerance scatterOneMissing{"scatterOneMissing", 2e-2,
                                             "neighbours of a pixel that counts no more"};
inline constexpr Tolerance widthsAgree{"widthsAgree", 1e-3, "between widths of vectors: the order of sums"};
inline constexpr Tolerance scatterUnits{
    "scatterUnits", 1e-3,
    "RMS, a tenth of the maximum: a ring of blocks with 0.4 % of the light may count or not"};

inline constexpr Tolerance keptOfHead{
    "keptOfHead", 0.2,
    "of the pixels of a front-lit head, at least: 0.22 of skin and 0.26 of a narrow profile measured. Of its "
    "tiles 0.33 and 0.47 could be left alone, of its pixels 0.61 and 0.74"};
inline constexpr Tolerance costOfTenth{"costOfTenth", 0.125,
                                       "of the whole: tiles and blocks that are covered in part count whole"};
inline constexpr Tolerance lightFlux{"lightFlux", 5e-3,
                                     "relative, RMS, far wider than the ball: a 256th of it lies beyond the "
                                     "profile's table, whose nodes end a little further out"};
inline constexpr Tolerance lightPlaces{
    "lightPlaces", 0.024, "as wide as the ball: blocks of texels half as wide as their distance"};
inline constexpr Tolerance lightTails{"lightTails", 0.04, "the same in the tails of narrow Gaussians"};
inline constexpr Tolerance lightHalves{"lightHalves", 2e-6, "the same sums in another order"};
inline constexpr Tolerance lightsAddUp{
    "lightsAddUp", 2e-2,
    "relative, RMS, on a ball narrower than the profile's radius: hidden weight is known if either light "
    "shows "
    "it, and bounds on what a slope takes away do not add up; 0.016 measured, 0.001 on one five times wider"};
inline constexpr Tolerance scatterLeftOut{
    "scatterLeftOut", 1.6,
    "of targetError, the worst pixel of several bodies: second differences measure, they do not bound; "
    "1.45 measured"};
inline constexpr Tolerance tapsOfLargeError{
    "tapsOfLargeError", 0.85, "of those at the default, with ten times its error: 0.70 to 0.77 measured"};
inline constexpr Tolerance scatterSeam{"scatterSeam", 1.6,
                                       "the same, over the borders of tiles that took different ways"};
inline constexpr Tolerance scatterFade{
    "scatterFade", 0.1, "of targetError: how much more a tile steps that begins to count; 0.03 measured"};
inline constexpr Tolerance scatterBluer{
    "scatterBluer", 0.01,
    "of white, in a dark gap: 0.006 in one pixel that few blocks round it are the same surface as"};
inline constexpr Tolerance scatterWideRms{"scatterWideRms", 1.4e-2,
                                          "a Gaussian of 96 pixels against its closed form; 1.2e-2 measured"};
inline constexpr Tolerance scatterWideMost{
    "scatterWideMost", 5e-2, "the same at the worst pixel, at the picture's border; 4.5e-2 measured"};
inline constexpr Tolerance scatterStep{"scatterStep", 1e-3,
                                       "of white: how far the grid of pixels shows while it moves"};

inline constexpr Tolerance lightThroughBall{"lightThroughBall", 0.12,
                                            "relative, RMS: in the tails of Gaussians alone, blocks of "
                                            "texels half as wide as their distance are 10 % off"};
inline constexpr Tolerance hiddenThroughBall{"hiddenThroughBall", 0.2,
                                             "the same for blocks of 2 x 2 of 24 x 24 pixels, and as far as "
                                             "the screen lacks weight: 0.14 to 0.19 measured"};
inline constexpr Tolerance throughSheet{
    "throughSheet", 0.18,
    "of red: 2 x 2 pixels at the edge of a strip of eight; 0.16 measured, 0.02 in its middle"};
inline constexpr Tolerance lightSeenTwice{"lightSeenTwice", 4e-3, "two ways to divide a sum by its weights"};

// --- against the surface integral of a head, RMSE in 1e-4 of radiance, albedo 0.8 ---
inline constexpr Tolerance headOnScreenRed{"headOnScreenRed", 40, "Lambert with ray-traced shadows: 85"};
inline constexpr Tolerance headOnScreenGreen{"headOnScreenGreen", 14, "Lambert: 30"};
inline constexpr Tolerance headOnScreenBlue{"headOnScreenBlue", 9, "Lambert: 14"};
inline constexpr Tolerance lightHead[3] = {{"lightHeadRed", 28, "screen and maps; 25.0 measured, 31 without"},
                                           {"lightHeadGreen", 12.8, "11.4 measured"},
                                           {"lightHeadBlue", 9, "8.5 measured"}};
inline constexpr Tolerance lightFour[3] = {
    {"lightFourRed", 106, "102 measured; Lambert 324, 123 without a map"},
    {"lightFourGreen", 67, "65 measured; Lambert 161, 68 without"},
    {"lightFourBlue", 52, "49 measured; Lambert 99"}};
inline constexpr Tolerance gain{"gain", 6e-3, "curvature by differences of float positions over a window"};
inline constexpr Tolerance walkHead[3] = {
    {"walkHeadRed", 61, "against random walks: 58; 84 without directions and gain"},
    {"walkHeadGreen", 45, "42; 49 without"},
    {"walkHeadBlue", 51, "49; 49 without"}};
inline constexpr Tolerance walkHeadTimesFour[3] = {
    {"walkHeadTimesFourRed", 187, "against random walks: 178; 212 without directions and gain"},
    {"walkHeadTimesFourGreen", 79, "75; 107 without"},
    {"walkHeadTimesFourBlue", 54, "50; 69 without"}};
inline constexpr Tolerance lightEar[3] = {
    {"lightEarRed", 20, "lit from behind, its unlit side: 17.3 measured; Lambert 50"},
    {"lightEarGreen", 9.3, "8.8 measured; Lambert 12"},
    {"lightEarBlue", 4, "3.5 measured; Lambert 4"}};
inline constexpr Tolerance lightBall[3] = {{"lightBallRed", 6, "4.5 measured; Lambert 42"},
                                           {"lightBallGreen", 2, "1.4 measured; Lambert 8.7"},
                                           {"lightBallBlue", 1.3, "1.0 measured; Lambert 3.1"}};
inline constexpr Tolerance lightBallOfLight[3] = {
    {"lightBallOfLightRed", 8, "scattering `light`; 6.7 measured"},
    {"lightBallOfLightGreen", 6.5, "5.6 measured"},
    {"lightBallOfLightBlue", 6, "5.2 measured: triangles lean from the ball by up to 0.026"}};
inline constexpr Tolerance lightHeadOfLight[3] = {
    {"lightHeadOfLightRed", 16, "scattering `light`; 14.1 measured"},
    {"lightHeadOfLightGreen", 9.7, "8.7 measured"},
    {"lightHeadOfLightBlue", 8.7, "7.9 measured"}};
inline constexpr Tolerance lightFourOfLight[3] = {{"lightFourOfLightRed", 36, "31 measured"},
                                                  {"lightFourOfLightGreen", 45, "40 measured"},
                                                  {"lightFourOfLightBlue", 44, "40 measured"}};
inline constexpr Tolerance lightEarOfLight[3] = {{"lightEarOfLightRed", 9.5, "8.2 measured"},
                                                 {"lightEarOfLightGreen", 6, "5.2 measured"},
                                                 {"lightEarOfLightBlue", 3.5, "3.0 measured"}};
inline constexpr Tolerance headByMapBlue{"headByMapBlue", 23, "irradiance alone, from texels of 0.33 mm: 22"};
inline constexpr Tolerance scatterTapsRms{
    "scatterTapsRms", 2e-3,
    "taps that round to another pixel, where the profile's table ends a node further out"};
inline constexpr Tolerance scatterTapsMost{"scatterTapsMost", 4e-2, "the same, of the worst pixel"};
inline constexpr Tolerance scatterManyTaps{"scatterManyTaps", 6e-3, "256 taps on a disk against every pixel"};
inline constexpr Tolerance textureEdge{"textureEdge", 1e-2,
                                       "Gaussians sampled at half a sigma, of a step one texel wide"};
inline constexpr Tolerance texturePlane{"texturePlane", 4.5e-3,
                                        "the narrowest Gaussians are below a texel there"};
inline constexpr Tolerance textureSphere{"textureSphere", 1.3e-3, "texels along u and v stand for distances"};
inline constexpr Tolerance sharpEdge{
    "sharpEdge", 0.18,
    "RMS of light within two texels of an edge: 0.172; texels tell its place to a fifth of one"};
inline constexpr Tolerance sharpRoundEdge{"sharpRoundEdge", 0.15, "the same of a ball's outline"};
inline constexpr Tolerance sharpShadow{
    "sharpShadow", 2e-3, "depths are floats over 300 texels' lengths; differences of them count three times"};

// --- memory ---
inline constexpr Tolerance heldMemory{"heldMemory", 0.05,
                                      "tables of profiles and lists of a few hundred bytes are not counted"};

// --- tables as BC6H ---
inline constexpr Tolerance bc6hMax{
    "bc6hMax", 0.016, "64x64: one byte per texel cannot follow three channels that part at the terminator"};
inline constexpr Tolerance bc6hRms{"bc6hRms", 1.6e-3, "64x64: 1.4e-3 measured"};

// --- eyes ---
inline constexpr Tolerance eyeLutRms{
    "eyeLutRms", 1e-2, "RMS, of the table's mean; 0.7 % measured, of which the photons' noise is half"};
inline constexpr Tolerance eyeLutFlux{"eyeLutFlux", 1e-3, "flux on the texels, relative"};
inline constexpr Tolerance eyeLutPlain{
    "eyeLutPlain", 2e-2, "one texel without its own cell on each side: about 2.5 cells make a mean"};
inline constexpr Tolerance eyeLutMean{"eyeLutMean", 2e-3, "texels that the rim cuts count by their area"};
inline constexpr Tolerance eyeLutScattered{"eyeLutScattered", 2e-4,
                                           "means over texels by 8 x 8 points in both"};
inline constexpr Tolerance eyePictureRms{"eyePictureRms", 2e-3,
                                         "RMS of an eye's pixels, white is 1: refraction, gloss"};
inline constexpr Tolerance eyeCausticRms{"eyeCausticRms", 1e-2,
                                         "the same, with caustics from a table of 64 x 64 x 32"};
inline constexpr Tolerance eyeMinified{
    "eyeMinified", 0.05,
    "RMS of an iris against one that is evenly grey: neighbouring levels differ by this"};

}  // namespace tolerance
