// Directions of the search.
#pragma once
#include "stability.h"

namespace stability {

inline reference::Vec3 vector(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

// `axis` turned by an angle, towards the side that `around` (0 to 1, a full turn) says.
inline reference::Vec3 turned(reference::Vec3 axis, double angle, double around) {
    const reference::Vec3 side = reference::normalized(reference::cross(axis, std::abs(axis.x) < 0.7
                                                                                  ? reference::Vec3{1, 0, 0}
                                                                                  : reference::Vec3{0, 1, 0})),
                          other = reference::cross(axis, side);
    const double turn = 2 * 3.14159265358979323846 * around;
    return reference::normalized(std::cos(angle) * axis +
                                 std::sin(angle) * (std::cos(turn) * side + std::sin(turn) * other));
}

}  // namespace stability
