// Colour differences as people see them.
#pragma once
#include <array>

namespace pellucid::io {

using Lab = std::array<double, 3>;

// CIE L*a*b* of linear sRGB, D65 white; negative components count as 0.
Lab labFromLinear(const std::array<double, 3>& rgb);

// CIEDE2000 (CIE 142-2001) with all parametric factors 1, as spelled out by Sharma, Wu & Dalal 2005. About 1
// can just be seen.
double deltaE2000(const Lab& one, const Lab& two);

}  // namespace pellucid::io
