// Part of test_never_worse.cpp. Only shadows that a map blurs by about a texel are there, and they blur what blue light does not.
constexpr Known knownWorse[] = {
    {"auto", "female, side", "terminator", {0, 0, 46}},
    {"auto", "female, behind", "terminator", {0, 0, 37}},
    {"auto", "female nose, side", "terminator", {0, 0, 41}},
    {"auto", "male ear, side", "terminator", {0, 0, 58}},
    {"auto", "male ear, side", "penumbra", {0, 695, 828}},
    {"auto", "male ear, behind", "terminator", {0, 0, 95}},
    {"auto", "male ear, behind", "penumbra", {0, 0, 350}},
    {"auto", "male, side", "terminator", {0, 44, 44}},
    {"auto", "male, behind", "terminator", {0, 30, 26}},
};
