"""GLSL 3.30 of the viewer's renderer."""

GBUFFER_VERTEX = """
#version 330 core
uniform mat4 clip;           // world to clip space, y turned round: the first row of the image is its top
in vec3 in_position, in_normal, in_albedo;
in vec2 in_material;         // id, curvature
in vec3 in_uv;               // u, v, and the albedo picture
out vec3 position, normal, albedo;
out vec2 uv;
out float curvature;
flat out float id, layer;
void main() {
    layer = in_uv.z;
    position = in_position; normal = in_normal; albedo = in_albedo;
    id = in_material.x; curvature = in_material.y; uv = in_uv.xy;
    gl_Position = clip * vec4(in_position, 1.0);
}
"""

# Pores and folds are gradients of smooth noise in space, faded out where a pixel is wider than they are.
GBUFFER_FRAGMENT = """
#version 330 core
uniform float pores;          // root mean square slope, about
uniform float mm;             // millimetres per unit
uniform bool eyes;
uniform vec3 sclera;          // the shader's eyes have irises of their own
uniform sampler2DArray pictures;  // of albedo
uniform sampler2D bumps;      // normal map of skin
uniform float bumps_up;       // 1 or -1: whether v grows towards the top of that picture; 0: there is none
in vec3 position, normal, albedo;
in vec2 uv;
in float curvature;
flat in float id, layer;
layout(location = 0) out vec4 out_position;   // xyz, id
layout(location = 1) out vec4 out_geometric;  // Ng, curvature
layout(location = 2) out vec4 out_shading;    // N, u
layout(location = 3) out vec4 out_albedo;     // rgb, v

vec3 hash(vec3 p) {
    uvec3 q = uvec3(ivec3(p)) * uvec3(1597334673u, 3812015801u, 2798796415u);
    uint n = (q.x ^ q.y ^ q.z) * 1597334673u;
    return vec3(uvec3(n, n * 16807u, n * 48271u) >> 8) / 8388608.0 - 1.0;
}
// Gradient of trilinear-smooth noise.
vec3 slope(vec3 p) {
    vec3 i = floor(p), f = p - i, u = f * f * (3.0 - 2.0 * f);
    vec3 s = vec3(0.0);
    for (int k = 0; k < 8; ++k) {
        vec3 c = vec3(k & 1, (k >> 1) & 1, k >> 2);
        vec3 w = mix(1.0 - u, u, c);
        s += w.x * w.y * w.z * hash(i + c);
    }
    return s;
}
// The normal of the map, by the directions in which u and v grow.
vec3 mapped(vec3 n) {
    vec3 px = dFdx(position), py = dFdy(position);
    vec2 tx = dFdx(uv), ty = dFdy(uv);
    float turn = tx.x * ty.y - ty.x * tx.y;
    vec3 t = (px * ty.y - py * tx.y) * sign(turn), b = (py * tx.x - px * ty.x) * sign(turn) * bumps_up;
    t -= n * dot(n, t);
    b -= n * dot(n, b);
    vec3 m = texture(bumps, uv).xyz * 2.0 - 1.0;
    if (dot(t, t) == 0.0 || dot(b, b) == 0.0 || dot(m, m) == 0.0) return n;
    return normalize(normalize(t) * m.x + normalize(b) * m.y + n * max(m.z, 0.05));
}
void main() {
    vec3 ng = normalize(normal), n = ng, color = albedo;
    if (layer >= 0.0) color *= texture(pictures, vec3(uv, layer)).rgb;
    if (id == 1.0 && bumps_up != 0.0) n = mapped(ng);
    float pixel = length(fwidth(position)) * mm;
    if (id == 1.0 && pores > 0.0) {
        vec3 p = position * mm;
        float fine = 1.0 - smoothstep(0.3, 0.9, pixel), coarse = 1.0 - smoothstep(1.5, 5.0, pixel);
        vec3 bump = 1.6 * fine * slope(p / 0.7) + 0.5 * coarse * slope(p / 4.0);
        n = normalize(n - pores * (bump - n * dot(n, bump)));
    } else if ((id == 2.0 || id == 6.0) && eyes) {
        color = sclera;
    }
    out_position = vec4(position, id);
    out_geometric = vec4(ng, curvature);
    out_shading = vec4(n, uv.x);
    out_albedo = vec4(color, uv.y);
}
"""

SHADOW_VERTEX = """
#version 330 core
uniform mat4 clip;
in vec3 in_position;
void main() { gl_Position = clip * vec4(in_position, 1.0); }
"""

SHADOW_FRAGMENT = """
#version 330 core
layout(location = 0) out float depth;
void main() { depth = gl_FragCoord.z; }
"""

ENLARGE_VERTEX = """
#version 330 core
uniform mat4 clip, small, rest;  // world to clip space: now, in the small picture, and in the one at rest
in vec3 in_position;
out vec4 place, before;          // in the small picture, and in the one at rest
void main() {
    vec4 p = vec4(in_position, 1.0);
    gl_Position = clip * p;
    place = small * p;
    before = rest * p;
}
"""

_MIXED = """
// The sum of the small pixel `low`, the one to its right, the one below, and the one below that.
vec3 mixed(sampler2D shaded, vec2 low, vec4 w) {
    ivec2 last = textureSize(shaded, 0) - 1;
    ivec2 a = clamp(ivec2(low), ivec2(0), last), d = clamp(ivec2(low) + 1, ivec2(0), last);
    return w.x * texelFetch(shaded, a, 0).rgb + w.y * texelFetch(shaded, ivec2(d.x, a.y), 0).rgb +
           w.z * texelFetch(shaded, ivec2(a.x, d.y), 0).rgb + w.w * texelFetch(shaded, d, 0).rgb;
}
"""

# Joint bilateral upsampling [Kopf et al. 2007]: of the four nearest shaded pixels those count that lie on the
# plane of this one. What the picture at rest shows beyond such a picture is added where it saw this place. Of
# eyes all is taken from it: what they refract moves beneath their surface.
ENLARGE_FRAGMENT = """
#version 330 core
uniform sampler2D shaded, depths;       // small; depth from the eye
uniform sampler2D details, rest_depths; // 128 + half of what is added, in bytes
uniform float angle;                    // height of a small pixel at depth 1
uniform vec2 scale;                     // small pixels per pixel of the same view; 0: of another view
in vec4 place, before;
layout(location = 0) out vec4 color;
layout(location = 1) out vec4 weights;  // these two for REUSE_FRAGMENT
layout(location = 2) out vec4 more;     // what is added; 1 + the part of the light that is left out
""" + _MIXED + """
void main() {
    float depth = place.w, size = depth * angle;
    ivec2 last = textureSize(depths, 0) - 1;
    vec2 at = scale.x > 0.0 ? gl_FragCoord.xy * scale : (0.5 + 0.5 * place.xy / depth) * vec2(last + 1);
    vec2 low = floor(at - 0.5), f = at - 0.5 - low;
    ivec2 a = clamp(ivec2(low), ivec2(0), last), d = clamp(ivec2(low) + 1, ivec2(0), last);
    ivec2 b = ivec2(d.x, a.y), c = ivec2(a.x, d.y);
    vec4 there = vec4(texelFetch(depths, a, 0).x, texelFetch(depths, b, 0).x, texelFetch(depths, c, 0).x,
                      texelFetch(depths, d, 0).x);
    vec2 slope = clamp(vec2(dFdx(depth) / dFdx(at.x), dFdy(depth) / dFdy(at.y)), -8.0 * size, 8.0 * size);
    vec4 x = vec4(-f.x, 1.0 - f.x, -f.x, 1.0 - f.x), y = vec4(-f.yy, 1.0 - f.yy);
    vec4 off = (there - depth - x * slope.x - y * slope.y) / (size + 0.5 * (abs(slope.x) + abs(slope.y)));
    off *= off;
    weights = ((1.0 - abs(x)) * (1.0 - abs(y)) + 0.005) / (0.02 + off * off);
    weights /= weights.x + weights.y + weights.z + weights.w;
    more = vec4(0.0, 0.0, 0.0, 1.0);
#ifdef DETAILED
    vec2 then = 0.5 + 0.5 * before.xy / before.w;
    float hidden = abs(texture(rest_depths, then).x - before.w) / size;
    vec4 found = texture(details, then);
    more += clamp(2.0 - hidden, 0.0, 1.0) * vec4(2.0 * found.rgb - 256.0 / 255.0, found.a);
#endif
    color = vec4(mixed(shaded, low, weights) * (2.0 - more.a) + more.rgb, 1.0);
}
"""

WHOLE_VERTEX = """
#version 330 core
void main() { gl_Position = vec4(4.0 * (gl_VertexID & 1) - 1.0, 2.0 * (gl_VertexID & 2) - 1.0, 0.0, 1.0); }
"""

# The same from what ENLARGE_FRAGMENT wrote beside its picture of this view: other light, no mesh.
REUSE_FRAGMENT = """
#version 330 core
uniform sampler2D shaded, weights, more;
uniform vec2 scale;
layout(location = 0) out vec4 color;
""" + _MIXED + """
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 m = texelFetch(more, at, 0);
    if (m.a < 1.0) discard;  // background
    vec3 light = mixed(shaded, floor(gl_FragCoord.xy * scale - 0.5), texelFetch(weights, at, 0));
    color = vec4(light * (2.0 - m.a) + m.rgb, 1.0);
}
"""
