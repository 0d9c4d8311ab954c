// Part of test_never_worse.cpp. Only shadows from a map are there, at a few pixels within a fifth of a texel of a shadow's edge, or behind
// what is thinner than a texel: docs/design-notes.md, "Against Lambert with a ray-traced shadow", has why.
constexpr Known knownWorse[] = {
    {"auto", "female, side", "terminator", {0, 0, 43}},
    {"auto", "male ear, side", "terminator", {0, 0, 43}},
    {"auto", "male ear, side", "penumbra", {0, 597, 719}},
    {"auto", "male ear, behind", "terminator", {0, 0, 85}},
    {"auto", "male ear, behind", "penumbra", {0, 0, 293}},
    {"auto", "male, side", "terminator", {0, 48, 48}},
    {"auto", "male, behind", "terminator", {0, 33, 29}},
};
