// Part of test_auto_against_lambert.cpp. Only shadows from a map are there, at a few pixels within a fifth
// of a texel of a shadow's edge, or behind what is thinner than a texel: docs/design-notes.md, "Against
// Lambert with a ray-traced shadow", has why.
constexpr Known knownWorse[] = {
    {"auto", "male ear, side", "terminator", {0, 0, 36}},
    {"auto", "male ear, behind", "terminator", {0, 0, 81}},
    {"auto", "male, side", "terminator", {0, 42, 42}},
    {"auto", "male, behind", "terminator", {0, 33, 29}},
};
