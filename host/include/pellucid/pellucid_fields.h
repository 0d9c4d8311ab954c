/* Number fields of the structures of pellucid.h, one row each:
 *
 *     X(type, name, default, min, max, special, unit, key, slider, words)
 *
 * type     FLOAT, UINT or COLOR (3 floats): every component lies between min and max or equals `special`,
 *          a value with a meaning of its own. The library checks it where the field is set, readers of files
 *          where they read it.
 *          FREE (a float), FREE_UINT, VECTOR (3 floats) and MATRIX (16): any finite value; the code that
 *          reads the field checks it.
 * default  one value for all components; VECTOR: (x, y, z); MATRIX: PEL_IDENTITY
 * min, max, special   constants of host/fields/field_ranges.h, or numbers
 * unit     of lengths: "mm", or "length" for the unit of the caller's positions; "" for others
 * key      in scene files and in Python
 * slider   of the viewer: PEL_SLIDER(label, min, max, step), or PEL_NO_SLIDER
 * words    for the tables of docs/guide, which docs/field_tables writes
 *
 * From these rows follow the defaults (pellucid_defaults.h), the checks and their messages
 * (host/fields/field_ranges.h), the keys of scene files (host/io/scene/scene_keys.h), the sliders of the
 * viewer and the tables of the guide. CONTRIBUTING.md, "A new field", lists what a field needs. */
#ifndef PELLUCID_FIELDS_H
#define PELLUCID_FIELDS_H
/* clang-format off */

#define PEL_EACH_MATERIAL_FIELD(X) \
    X(COLOR, albedo, 0.5f, 0, PEL_HUGE, PEL_NONE, "", "albedo", PEL_NO_SLIDER, \
      "RGB, where there is no albedo image") \
    X(FLOAT, diffusionRadius, 0, PEL_TINY, PEL_HUGE, 0, "length", "diffusion_radius", PEL_NO_SLIDER, \
      "0: that of the profile, else of the tables") \
    X(COLOR, normalBlend, -1, 0, 1, -1, "", "normal_blend", PEL_NO_SLIDER, \
      "RGB: how far the blurred normal replaces the shading normal; -1: the profile's, else 1, 0.3, 0") \
    X(FLOAT, shadowFilterWidth, 0, PEL_TINY, PEL_HUGE, 0, "length", "shadow_filter_width", PEL_NO_SLIDER, \
      "penumbra of the wide shadow where the surface faces the light; 0: from the profile, else 8 mm") \
    X(FLOAT, transmission, 1, 0, PEL_HUGE, PEL_NONE, "", "transmission", PEL_SLIDER("Transmission", 0, \
      2, 0.05), \
      "share of the light that the profile lets through thin parts; a `deep_scatter_color` replaces it") \
    X(FLOAT, curvatureGain, 1, 0, PEL_HUGE, PEL_NONE, "", "curvature_gain", PEL_NO_SLIDER, \
      "how much more curved bodies reflect, for Burley and dipole profiles; 0: no gain") \
    X(COLOR, deepScatterColor, 0, 0, PEL_HUGE, PEL_NONE, "", "deep_scatter_color", PEL_NO_SLIDER, \
      "RGB; 0: no deep scatter") \
    X(FLOAT, deepScatterRadius, 6, PEL_TINY, PEL_HUGE, PEL_NONE, "length", "deep_scatter_radius", \
      PEL_NO_SLIDER, \
      "standard deviation of the transmission through thickness") \
    X(FLOAT, deepScatterNormalOffset, 0.2f, -PEL_HUGE, PEL_HUGE, PEL_NONE, "length", \
      "deep_scatter_normal_offset", \
      PEL_NO_SLIDER, "inwards (below 0 outwards), before thickness is measured") \
    X(FLOAT, deepScatterAmbient, 0, 0, PEL_HUGE, PEL_NONE, "", "deep_scatter_ambient", PEL_NO_SLIDER, \
      "share of ambient light that comes through from behind; needs a `thickness` channel, measured " \
      "along the inward normal") \
    X(FLOAT, thicknessFilterRadius, 0.02f, 0, 1, PEL_NONE, "", "thickness_filter_radius", PEL_NO_SLIDER, \
      "of the disk of taps, in UV of the shadow map") \
    X(UINT, thicknessTaps, 32, 8, 32, 0, "", "thickness_taps", PEL_NO_SLIDER, \
      "8, 16 or 32; 0: thickness is not measured") \
    X(FLOAT, specular, 0, 0, PEL_HUGE, PEL_NONE, "", "specular", PEL_SLIDER("Specular", 0, 1, 0.01), \
      "ρ_s; 0: no specular light") \
    X(FLOAT, roughness, 0.3f, 0, PEL_HUGE, PEL_NONE, "", "roughness", PEL_SLIDER("Roughness", 0.05, 1, \
      0.01), \
      "m of Beckmann, or of the first lobe of GGX") \
    X(FLOAT, roughness2, 0.15f, 0, PEL_HUGE, PEL_NONE, "", "roughness2", \
      PEL_SLIDER("Second roughness", 0.05, 1, 0.01), "of the second lobe of GGX") \
    X(FLOAT, lobeMix, 0.15f, 0, 1, PEL_NONE, "", "lobe_mix", PEL_SLIDER("Second lobe weight", 0, 1, 0.01), \
      "weight of the second lobe of GGX") \
    X(FLOAT, f0, 0.028f, 0, 1, PEL_NONE, "", "f0", PEL_SLIDER("f0", 0, 0.2, 0.002), \
      "reflectance at normal incidence") \
    X(FLOAT, uvScale, 1, PEL_TINY, PEL_HUGE, PEL_NONE, "length", "uv_scale", PEL_NO_SLIDER, \
      "per unit of u or v on the surface ([curvature.md](curvature.md))") \
    X(FLOAT, thinThickness, 0, 0, PEL_HUGE, PEL_NONE, "length", "thin_thickness", PEL_NO_SLIDER, \
      "above 0 the surface is a sheet this thick that lets light through from its other side") \
    PEL_EACH_SCATTER_CONTROL_FIELD(X)

/* Of PelMaterial and of PelScatterControls. */
#define PEL_EACH_SCATTER_CONTROL_FIELD(X) \
    X(UINT, scatterTaps, 0, 8, 256, 0, "", "scatter_taps", PEL_NO_SLIDER, \
      "\"separable\": taps of each filter, 0: 25; \"screen\": taps on a disk, 0: the whole profile") \
    X(FLOAT, albedoBefore, 0, 0, 1, PEL_NONE, "", "albedo_before", PEL_NO_SLIDER, \
      "m: irradiance is multiplied by albedo^m before it scatters and by albedo^(1 − m) after") \
    X(COLOR, borderColor, 0, 0, 1, PEL_NONE, "", "border_color", PEL_NO_SLIDER, \
      "RGB: share of the light that flows in from other materials that scatter")

#define PEL_EACH_LIGHT_FIELD(X) \
    X(COLOR, color, 1, 0, PEL_HUGE, PEL_NONE, "", "color", PEL_NO_SLIDER, \
      "RGB. Directional: irradiance / π at normal incidence; others: that at distance 1, of a rectangle " \
      "along its axis") \
    X(UINT, plainShadow, 0, 0, 1, PEL_NONE, "", "plain_shadow", PEL_NO_SLIDER, \
      "1: `wide_shadow` is the visible share of the light, with sharp edges or true penumbrae, not " \
      "filtered for tables; `auto` can then scatter on the screen")
/* Of directional lights, of all others, of spots, spheres and rectangles; checked only for these types. */
#define PEL_EACH_DIRECTIONAL_LIGHT_FIELD(X) \
    X(VECTOR, toLight, (0, 0, 1), -PEL_FINITE, PEL_FINITE, PEL_NONE, "", "to_light", PEL_NO_SLIDER, \
      "directional: from the surface to the light; files: made unit")
#define PEL_EACH_POSITIONAL_LIGHT_FIELD(X) \
    X(VECTOR, position, (0, 0, 0), -PEL_FINITE, PEL_FINITE, PEL_NONE, "length", "position", PEL_NO_SLIDER, \
      "all but directional: world; of a sphere or rectangle the centre") \
    X(FLOAT, range, 0, 0, PEL_HUGE, PEL_NONE, "length", "range", PEL_NO_SLIDER, \
      "all but directional: distance beyond which there is no light; 0: no limit")
#define PEL_EACH_SPOT_LIGHT_FIELD(X) \
    X(VECTOR, spotDirection, (0, 0, -1), -PEL_FINITE, PEL_FINITE, PEL_NONE, "", "spot_direction", \
      PEL_NO_SLIDER, \
      "spot: the direction of its axis; files: made unit") \
    X(FLOAT, spotCosInner, 0.9f, -1, 1, PEL_NONE, "", "spot_cos_inner", PEL_NO_SLIDER, \
      "cosine of the angle up to which a spot is fully bright") \
    X(FLOAT, spotCosOuter, 0.8f, -1, 1, PEL_NONE, "", "spot_cos_outer", PEL_NO_SLIDER, \
      "cosine of the angle from which a spot is dark")
#define PEL_EACH_SPHERE_LIGHT_FIELD(X) \
    X(FLOAT, radius, 0, 0, PEL_HUGE, PEL_NONE, "length", "radius", PEL_NO_SLIDER, "sphere; 0: a point")
#define PEL_EACH_RECTANGLE_LIGHT_FIELD(X) \
    X(VECTOR, halfWidth, (1, 0, 0), -PEL_FINITE, PEL_FINITE, PEL_NONE, "length", "half_width", \
      PEL_NO_SLIDER, \
      "rectangle: from its centre to the middle of a side") \
    X(VECTOR, halfHeight, (0, 1, 0), -PEL_FINITE, PEL_FINITE, PEL_NONE, "length", "half_height", \
      PEL_NO_SLIDER, \
      "rectangle: to the middle of the next side, at a right angle; it shines along `half_width` × " \
      "`half_height`")

/* Of PelLight: its shadow map. */
#define PEL_EACH_SHADOW_MAP_FIELD(X) \
    X(MATRIX, worldToShadow, PEL_IDENTITY, -PEL_FINITE, PEL_FINITE, PEL_NONE, "", "world_to_shadow", \
      PEL_NO_SLIDER, \
      "world to homogeneous (u, v, z): u, v in [0, 1] over the image, row 0 at v = 0; z as in the " \
      "image. Cubes: world to " \
      "the space of the cube, the light at the origin") \
    X(FREE, shadowDepthRange, 1, -PEL_FINITE, PEL_FINITE, PEL_NONE, "length", "depth_range", PEL_NO_SLIDER, \
      "parallel: what z from 0 to 1 spans; negative if z decreases away from the light. `\"cube-" \
      "radial\"`: distance from the " \
      "light at z = 1") \
    X(FREE, shadowDepthA, 0, -PEL_FINITE, PEL_FINITE, PEL_NONE, "", "depth_a", PEL_NO_SLIDER, \
      "perspective, and cubes along the axis of a face: distance along the light = 1 / (a z + b), " \
      "from the projection matrix") \
    X(FREE, shadowDepthB, 0, -PEL_FINITE, PEL_FINITE, PEL_NONE, "", "depth_b", PEL_NO_SLIDER, \
      "b of the same") \
    X(UINT, shadowFilterTexels, 48, 4, 256, 0, "", "filter_texels", PEL_NO_SLIDER, \
      "without `wide_shadow`: the wide shadow is filtered from this map with at most so many texels " \
      "across; 0: materials of " \
      "\"preintegrated\" get no shadow from it") \
    X(FLOAT, shadowBias, -1, 0, PEL_HUGE, -1, "length", "bias", PEL_NO_SLIDER, \
      "an occluder counts only if it is this far in front of the surface; -1: from the profile, else " \
      "0.5 mm") \
    X(FLOAT, shadowSoftness, -1, 1e-3f, PEL_HUGE, -1, "", "softness", PEL_NO_SLIDER, \
      "times `shadow_filter_width`: distance over which an occluder fades in beyond the bias; -1: from " \
      "the profile, else 0.25") \
    X(FLOAT, shadowConeSlope, -1, 0, PEL_HUGE, -1, "", "cone_slope", PEL_NO_SLIDER, \
      "growth of the bias by sideways distance; -1: from the profile, else 0.5") \
    X(FREE, shadowExponent, 0, -PEL_FINITE, PEL_FINITE, PEL_NONE, "", "exponent", PEL_NO_SLIDER, \
      "exponential: of the sign with which `exponent` z grows away from the light; 80 for float images") \
    X(FLOAT, shadowMinDeviation, 0.25f, 0, PEL_HUGE, PEL_NONE, "length", "min_deviation", PEL_NO_SLIDER, \
      "moments: minimum standard deviation") \
    X(FLOAT, shadowBleeding, 0.1f, 0, 0.999f, PEL_NONE, "", "bleeding", PEL_NO_SLIDER, \
      "moments: visibility up to this share counts as full shadow") \
    X(UINT, shadowCascades, 0, 0, 4, PEL_NONE, "", "cascades", PEL_NO_SLIDER, \
      "directional, parallel: number of maps, this one the finest; 0: one map that is no cascade")

#define PEL_EACH_OPTION_FIELD(X) \
    X(FLOAT, targetError, 2e-3f, 0, 1, PEL_NONE, "", "target_error", PEL_SLIDER("Target error", 0.0005, \
      0.02, 0.0005), \
      "error allowed to methods that leave out small contributions, as a share of white") \
    X(FLOAT, millimetresPerUnit, 1, PEL_TINY, PEL_HUGE, PEL_NONE, "mm", "unit_mm", PEL_NO_SLIDER, \
      "of a unit of positions: profiles are in millimetres, every other length in the scene's unit") \
    X(FREE_UINT, blurNormals, 0, 0, 1, PEL_NONE, "", "blur_normals", PEL_NO_SLIDER, \
      "1: without a `normal_blurred` channel, normals are blurred on screen over the diffusion radius " \
      "([shading.md](shading.md))") \
    X(FREE_UINT, rotateTaps, 0, 0, 1, PEL_NONE, "", "rotate_taps", PEL_NO_SLIDER, \
      "1: the disk of thickness taps is rotated from pixel to pixel " \
      "([shading.md](shading.md#rotated-disk-of-taps))") \
    X(FREE_UINT, everyPixel, 0, 0, 1, PEL_NONE, "", "every_pixel", PEL_NO_SLIDER, \
      "1: wide shadows filtered from shadow maps, and thickness by taps, are computed at every pixel, " \
      "never interpolated ([shading.md](shading.md#between-pixels))") \
    X(FREE_UINT, frameIndex, 0, 0, PEL_FINITE, PEL_NONE, "", "frame_index", PEL_NO_SLIDER, \
      "seed of the random placement of scattering taps, for hosts that average frames") \
    X(FREE_UINT, halfRate, 0, 0, 1, PEL_NONE, "", "half_rate", PEL_NO_SLIDER, \
      "1: `light`, `separable`, and `screen` with taps compute every second pixel along both axes " \
      "([shading.md](shading.md#half-rate))") \
    X(FREE_UINT, buildInBackground, 0, 0, 1, PEL_NONE, "", "build_in_background", PEL_NO_SLIDER, \
      "1: programs that show frame after frame do not wait for kernels that must be built, and shade by " \
      "\"none\" until then ([devices.md](devices.md#the-first-picture)); those that write a picture wait") \
    X(FLOAT, timeBudget, 0, 0, PEL_FINITE, PEL_NONE, "", "time_budget", PEL_NO_SLIDER, \
      "milliseconds that `auto` may take beyond plain lighting, by what is known of the device; 0: no " \
      "limit ([shading.md](shading.md#time-budget))") \
    X(FLOAT, historyWeight, 0, 0, 0.95f, PEL_NONE, "", "history_weight", PEL_NO_SLIDER, \
      "share of earlier frames in light that is scattered by taps ([shading.md](shading.md#history))") \
    X(FREE_UINT, historyCut, 0, 0, PEL_FINITE, PEL_NONE, "", "history_cut", PEL_NO_SLIDER, \
      "if it differs from the previous frame, nothing is taken from earlier frames")

#define PEL_EACH_SCATTER_PARAM_FIELD(X) \
    X(FLOAT, targetError, 2e-3f, 0, PEL_FINITE, PEL_NONE, "", "target_error", PEL_NO_SLIDER, \
      "allowed error of the result, as a share of `white`") \
    X(FLOAT, white, 1, PEL_ABOVE_0, PEL_FINITE, PEL_NONE, "", "white", PEL_NO_SLIDER, \
      "irradiance that counts as white")

#define PEL_EACH_CURVATURE_LUT_FIELD(X) \
    X(UINT, width, 64, 1, 16384, PEL_NONE, "", "width", PEL_NO_SLIDER, "texels") \
    X(UINT, height, 64, 1, 16384, PEL_NONE, "", "height", PEL_NO_SLIDER, "texels") \
    X(FLOAT, diffusionRadius, 0, PEL_ABOVE_0, PEL_FINITE, 0, "length", "diffusion_radius", PEL_NO_SLIDER, \
      "0: the profile's own, in mm") \
    X(FLOAT, radiusMin, 0, PEL_ABOVE_0, PEL_FINITE, 0, "length", "radius_min", PEL_NO_SLIDER, \
      "smallest radius of curvature; 0: a quarter of the diffusion radius") \
    X(FLOAT, radiusMax, 0, PEL_ABOVE_0, PEL_FINITE, 0, "length", "radius_max", PEL_NO_SLIDER, \
      "largest radius of curvature; 0: a thousand diffusion radii")

#define PEL_EACH_SHADOW_LUT_FIELD(X) \
    X(UINT, width, 128, 1, 16384, PEL_NONE, "", "width", PEL_NO_SLIDER, "texels") \
    X(UINT, height, 32, 1, 16384, PEL_NONE, "", "height", PEL_NO_SLIDER, "texels") \
    X(FLOAT, diffusionRadius, 0, PEL_ABOVE_0, PEL_FINITE, 0, "length", "diffusion_radius", PEL_NO_SLIDER, \
      "0: the profile's own, in mm") \
    X(FLOAT, widthMin, 0, PEL_ABOVE_0, PEL_FINITE, 0, "length", "width_min", PEL_NO_SLIDER, \
      "narrowest penumbra; 0: the filter that follows from the profile") \
    X(FLOAT, widthMax, 0, PEL_ABOVE_0, PEL_FINITE, 0, "length", "width_max", PEL_NO_SLIDER, \
      "widest penumbra; 0: a thousand times the narrowest") \
    X(FLOAT, sharpening, 10, 1, PEL_FINITE, PEL_NONE, "", "sharpening", PEL_NO_SLIDER, \
      "how much narrower the shadow gets, from 1") \
    X(UINT, closedEnds, 1, 0, 1, PEL_NONE, "", "closed_ends", PEL_NO_SLIDER, \
      "1: each row is rescaled to run from 0 to 1")

#define PEL_EACH_SPECULAR_LUT_FIELD(X) \
    X(UINT, width, 512, 1, 16384, PEL_NONE, "", "width", PEL_NO_SLIDER, "texels") \
    X(UINT, height, 512, 1, 16384, PEL_NONE, "", "height", PEL_NO_SLIDER, "texels")

/* Defaults and ranges: Jacques, Optical properties of biological tissues: a review, 2013 (scattering of skin,
 * table 1, and its range there; melanosomes 1.3 to 43 % of the epidermis; blood); extremes of pathology. */
#define PEL_EACH_SKIN_FIELD(X) \
    X(FLOAT, melanin, 0.05f, 0, 0.5f, PEL_NONE, "", "melanin", PEL_SLIDER("Melanin", 0, 0.5, 0.005), \
      "share of the epidermis' volume: pale 0.01 to 0.06, brown 0.1 to 0.16, very dark 0.18 to 0.43") \
    X(FLOAT, eumelanin, 1, 0, 1, PEL_NONE, "", "eumelanin", PEL_SLIDER("Eumelanin", 0, 1, 0.01), \
      "share of the melanin; the rest is pheomelanin, which is redder") \
    X(FLOAT, blood, 0.02f, 0, 0.2f, PEL_NONE, "", "blood", PEL_SLIDER("Blood", 0, 0.2, 0.002), \
      "share of the dermis' volume: 0.002 to 0.07, more in lips and blushes") \
    X(FLOAT, oxygenation, 0.75f, 0, 1, PEL_NONE, "", "oxygenation", PEL_SLIDER("Oxygenation", 0, 1, 0.01), \
      "share of the haemoglobin that carries oxygen") \
    X(FLOAT, epidermis, 0.06f, 0.02f, 0.5f, PEL_NONE, "mm", "epidermis", \
      PEL_SLIDER("Epidermis, mm", 0.02, 0.5, 0.01), "its thickness: face 0.05 to 0.1, palms up to 0.5") \
    X(FLOAT, scattering, 4.6f, 2, 10, PEL_NONE, "", "scattering", PEL_NO_SLIDER, \
      "reduced scattering coefficient at 500 nm, 1/mm; measured 2.97 to 6.87") \
    X(FLOAT, scatteringPower, 1.421f, 0.5f, 2.5f, PEL_NONE, "", "scattering_power", PEL_NO_SLIDER, \
      "b of (wavelength / 500 nm)^-b, measured 0.7 to 2.45") \
    X(FLOAT, water, 0.65f, 0, 1, PEL_NONE, "", "water", PEL_NO_SLIDER, "share of the dermis' volume") \
    X(FLOAT, carotene, 0, 0, 100, PEL_NONE, "", "carotene", PEL_NO_SLIDER, \
      "mg per litre of epidermis: 0 to 1, much more after carrots") \
    X(FLOAT, bilirubin, 0, 0, 300, PEL_NONE, "", "bilirubin", PEL_NO_SLIDER, \
      "mg per litre of dermis: 0 to 10, in jaundice up to 300, in a bruise of some days")

/* Of PelEye and of PelEyeLutDesc. */
#define PEL_EACH_EYE_SHAPE_FIELD(X) \
    X(FLOAT, scleraRadius, 12, PEL_TINY, PEL_HUGE, PEL_NONE, "mm", "sclera_radius", PEL_NO_SLIDER, \
      "of the eyeball's sphere") \
    X(FLOAT, corneaRadius, 7.8f, PEL_TINY, PEL_HUGE, PEL_NONE, "mm", "cornea_radius", \
      PEL_SLIDER("Cornea radius, mm", 7, 10, 0.05), "of curvature at its apex") \
    X(FLOAT, corneaConic, -0.26f, -100, 100, PEL_NONE, "", "cornea_conic", PEL_NO_SLIDER, \
      "conic constant: 0 is a sphere, -1 a paraboloid") \
    X(FLOAT, limbusRadius, 6, PEL_TINY, PEL_HUGE, PEL_NONE, "mm", "limbus_radius", PEL_NO_SLIDER, \
      "of the circle in which cornea and sclera meet") \
    X(FLOAT, chamberDepth, 3.05f, PEL_TINY, PEL_HUGE, PEL_NONE, "mm", "chamber_depth", \
      PEL_SLIDER("Chamber depth, mm", 2.7, 4.5, 0.05), \
      "from the apex of the cornea to the plane of the iris' rim") \
    X(FLOAT, corneaIndex, 1.376f, 1, 3, PEL_NONE, "", "cornea_index", PEL_NO_SLIDER, "refractive index") \
    X(FLOAT, aqueousIndex, 1.336f, 1, 3, PEL_NONE, "", "aqueous_index", PEL_NO_SLIDER, \
      "refractive index behind the cornea") \
    X(FLOAT, irisRadius, 0, PEL_TINY, PEL_HUGE, 0, "mm", "iris_radius", PEL_NO_SLIDER, \
      "0: that of the limbus") \
    X(FLOAT, irisConcavity, 0, 0, PEL_HUGE, PEL_NONE, "mm", "iris_concavity", \
      PEL_SLIDER("Iris concavity, mm", 0, 1, 0.05), \
      "how much deeper than its rim the centre of the iris lies")

#define PEL_EACH_EYE_FIELD(X) \
    X(VECTOR, center, (0, 0, 0), -PEL_FINITE, PEL_FINITE, PEL_NONE, "length", "center", PEL_NO_SLIDER, \
      "of the sclera's sphere, world") \
    X(VECTOR, gaze, (0, 0, 1), -PEL_FINITE, PEL_FINITE, PEL_NONE, "", "gaze", PEL_NO_SLIDER, \
      "the direction in which it looks") \
    X(VECTOR, up, (0, 1, 0), -PEL_FINITE, PEL_FINITE, PEL_NONE, "", "up", PEL_NO_SLIDER, \
      "where the top of the texture is, not along `gaze`") \
    PEL_EACH_EYE_SHAPE_FIELD(X) \
    X(FLOAT, limbusWidth, 1, 0, PEL_HUGE, PEL_NONE, "mm", "limbus_width", PEL_SLIDER("Limbus width, \
      mm", 0.1, 3, 0.05), \
      "of the soft border between cornea and sclera") \
    X(FLOAT, limbusDarkening, 0.6f, 0, 1, PEL_NONE, "", "limbus_darkening", \
      PEL_SLIDER("Limbus darkening", 0, 1, 0.01), "share of the light that the rim of the iris absorbs") \
    X(FLOAT, pupilRadius, 2, 0, PEL_HUGE, PEL_NONE, "mm", "pupil_radius", PEL_SLIDER("Pupil radius, \
      mm", 0.5, 4, 0.1), \
      "less than that of the iris") \
    X(FLOAT, texturePupil, 0.3f, 0, 0.95f, PEL_NONE, "", "texture_pupil", PEL_NO_SLIDER, \
      "radius of the pupil in the texture, as a share of its rim's") \
    X(COLOR, irisColor, -1, 0, PEL_HUGE, -1, "", "iris_color", PEL_NO_SLIDER, \
      "RGB: multiplies the texture, or colours the fibres that are drawn without one; -1: 1, or 0.22," \
      " 0.12, 0.06") \
    X(FREE_UINT, irisSeed, 0, 0, PEL_FINITE, PEL_NONE, "", "iris_seed", PEL_SLIDER("Fibre pattern", 0, \
      20, 1), \
      "each number gives another pattern of fibres") \
    X(FLOAT, tearRoughness, 0.03f, 1e-3f, 1, PEL_NONE, "", "tear_roughness", \
      PEL_SLIDER("Tear roughness", 0.005, 0.3, 0.005), "GGX's alpha of the film of tears") \
    X(FLOAT, wetLineRoughness, 0.2f, 1e-3f, 1, PEL_NONE, "", "wet_line_roughness", PEL_NO_SLIDER, \
      "the same where `wetness` is 1") \
    X(FLOAT, tearIndex, 1.336f, 1, 3, PEL_NONE, "", "tear_index", PEL_NO_SLIDER, \
      "refractive index of the film; 1: no film")

#define PEL_EACH_EYE_LUT_FIELD(X) \
    PEL_EACH_EYE_SHAPE_FIELD(X) \
    X(UINT, width, 64, 2, 1024, PEL_NONE, "", "width", PEL_NO_SLIDER, "texels") \
    X(UINT, height, 64, 2, 1024, PEL_NONE, "", "height", PEL_NO_SLIDER, "texels") \
    X(UINT, depth, 32, 2, 256, PEL_NONE, "", "depth", PEL_NO_SLIDER, "slices") \
    X(FLOAT, millimetresPerUnit, 1, PEL_TINY, PEL_HUGE, PEL_NONE, "", "unit_mm", PEL_NO_SLIDER, \
      "units of the profile per unit of the lengths")

/* clang-format on */
#endif
