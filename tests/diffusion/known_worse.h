// Part of test_never_worse.cpp. Only shadows that a map blurs by about a texel are there, and they blur what blue light does not.
constexpr Known knownWorse[] = {
    {"auto", "female, side", "terminator", {0, 0, 46}},
    {"auto", "female, behind", "terminator", {0, 0, 37}},
    {"auto", "female nose, side", "terminator", {0, 0, 41}},
};
