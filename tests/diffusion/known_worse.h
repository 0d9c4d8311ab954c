// Part of test_never_worse.cpp.
constexpr Known knownWorse[] = {{"", "", "", {0, 0, 0}}};
