// The visible difference of two pictures that are shown alternately: LDR-FLIP [Andersson et al. 2020, FLIP: A
// Difference Evaluator for Alternating Images, Proc. ACM Comput. Graph. Interact. Tech. 3(2), article 15].
#pragma once
#include <span>

namespace pellucid::io {

// The mean over all pixels, 0 (equal) to 1; NaN for a picture with NaN. `a`, `b`: linear sRGB, interleaved,
// of `width` columns; values beyond 0 to 1 are clamped. Throws std::invalid_argument for sizes that do not
// match.
double flip(std::span<const float> a, std::span<const float> b, int width);

}  // namespace pellucid::io
