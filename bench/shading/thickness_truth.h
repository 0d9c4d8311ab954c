// Thickness from a shadow map by 4,096 taps in double precision: what fewer taps are measured against.
#pragma once
#include <pellucid/pellucid.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "io/image/image_file.h"
#include "reference/shade.h"

class ThicknessTruth {
  public:
    ThicknessTruth(const pellucid::io::Image& map, const PelLight& light, const PelMaterial& material)
        : map_{map.width, map.height, {map.channels[0].pixels.begin(), map.channels[0].pixels.end()}},
          depth_{false, light.shadowDepthRange, 0, 1},
          normalOffset_(material.deepScatterNormalOffset),
          radius_(material.thicknessFilterRadius) {
        for (size_t i = 0; i < 16; ++i) worldToShadow_[i / 4][i % 4] = light.worldToShadow[i];
        constexpr int count = 4096;  // a sunflower's spiral
        for (int i = 0; i < count; ++i) {
            const double r = std::sqrt((i + 0.5) / count), a = i * std::numbers::pi * (3 - std::sqrt(5.0));
            taps_.push_back({r * std::cos(a), r * std::sin(a)});
        }
    }
    // At a world position with that geometric normal, length.
    double at(const reference::Vec3& position, const reference::Vec3& normal) const {
        return thickness(map_, shadowCoordinates(worldToShadow_, position, normal, normalOffset_), taps_,
                         radius_, depth_, reference::MapFilter::bilinear);
    }

  private:
    reference::ShadowMap map_;
    reference::Matrix4 worldToShadow_;
    reference::DepthDecoding depth_;
    double normalOffset_, radius_;
    std::vector<reference::Vec2> taps_;
};
