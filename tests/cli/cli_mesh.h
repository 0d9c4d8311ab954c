// The command run on a small mesh.
#pragma once
#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "cli_run.h"

class CommandOnMesh : public CommandTest {
  protected:
    // A regular icosahedron of radius 2, faces outwards: its vertex normals are radial by symmetry.
    std::string icosahedron(const std::string& extraVertices = "", const std::string& extraFaces = "",
                            int vertices = 12, int faces = 20) const {
        const double g = (1 + std::sqrt(5.0)) / 2, scale = 2 / std::sqrt(1 + g * g), a = scale, b = g * scale;
        std::ostringstream text;
        text.precision(9);
        text << "OFF\n" << vertices << ' ' << faces << " 0\n";
        for (const auto& [x, y, z] : std::vector<std::array<double, 3>>{{-a, b, 0},
                                                                        {a, b, 0},
                                                                        {-a, -b, 0},
                                                                        {a, -b, 0},
                                                                        {0, -a, b},
                                                                        {0, a, b},
                                                                        {0, -a, -b},
                                                                        {0, a, -b},
                                                                        {b, 0, -a},
                                                                        {b, 0, a},
                                                                        {-b, 0, -a},
                                                                        {-b, 0, a}}) {
            text << x << ' ' << y << ' ' << z << '\n';
        }
        text << extraVertices;
        for (const char* face : {"0 11 5",  "0 5 1",  "0 1 7",  "0 7 10", "0 10 11", "1 5 9", "5 11 4",
                                 "11 10 2", "10 7 6", "7 1 8",  "3 9 4",  "3 4 2",   "3 2 6", "3 6 8",
                                 "3 8 9",   "4 9 5",  "2 4 11", "6 2 10", "8 6 7",   "9 8 1"}) {
            text << "3 " << face << '\n';
        }
        return write("mesh.off", text.str() + extraFaces);
    }
};
