// Triangles of one surface in one order.
#pragma once
#include <cstdint>
#include <vector>

namespace pel {

// Turns triangles round so that any two that share an edge with no third pass it in opposite directions. Of each connected part
// the order that most of its triangles have stays (of as many, that of its first one); parts that need nothing stay as they are.
// On a surface of one side (a Moebius strip) some edge stays wrong.
void orientTriangles(std::vector<uint32_t>& triangles);

}  // namespace pel
