// Curvature of meshes by each estimator and in each quantity, normals, UV scale.
#include "reference/curvature_quadric.h"

#include "meshes.h"

namespace stability {
namespace {

PelCurvatureParams estimated(PelCurvatureEstimator estimator,
                             PelCurvatureQuantity quantity = PEL_QUANTITY_ABSOLUTE) {
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = estimator;
    params.quantity = quantity;
    params.smoothingPasses = 0;
    return params;
}

class EdgeCurvature : public MovedMesh {
    using MovedMesh::MovedMesh;
    std::vector<float> measured() override { return curvature(estimated(PEL_CURVATURE_EDGE)); }
    std::vector<double> truth() override { return reference::edgeCurvature(mesh); }
};

std::vector<double> quantityOf(const reference::PrincipalCurvatures& k, PelCurvatureQuantity quantity) {
    switch (quantity) {
        case PEL_QUANTITY_ABSOLUTE:
            return {std::abs(k.mean())};
        case PEL_QUANTITY_ABSOLUTE_MAX:
            return {std::max(std::abs(k.first), std::abs(k.second))};
        case PEL_QUANTITY_CURVEDNESS:
            return {std::sqrt((k.first * k.first + k.second * k.second) / 2)};
        case PEL_QUANTITY_MEAN:
            return {k.mean()};
        case PEL_QUANTITY_GAUSSIAN:
            return {k.gaussian()};
        case PEL_QUANTITY_FIRST:
            return {k.first};
        case PEL_QUANTITY_SECOND:
            return {k.second};
        default:
            return {k.first, k.second};
    }
}

class TensorCurvature : public MovedMesh {
  public:
    TensorCurvature(const Point& p, PelCurvatureQuantity quantity) : MovedMesh(p), quantity_(quantity) {}
    std::vector<float> measured() override {
        return curvature(estimated(PEL_CURVATURE_TENSOR, quantity_),
                         quantity_ == PEL_QUANTITY_PRINCIPAL ? 2 : 1);
    }
    std::vector<double> truth() override {
        std::vector<double> t;
        for (const auto& k : reference::tensorCurvature(mesh))
            for (double v : quantityOf(k, quantity_)) t.push_back(v);
        return t;
    }

  private:
    PelCurvatureQuantity quantity_;
};

// Vertices whose fit comes too near a yes-or-no decision, or has fewer points than terms, are not compared.
std::vector<reference::QuadricCurvature> decided(const reference::Mesh& mesh) {
    auto all = reference::quadricCurvature(mesh);
    for (auto& k : all)
        if (k.margin < tolerance::quadricDecision || k.points < 9) k.first = k.second = NAN;
    return all;
}

class QuadricCurvature : public MovedMesh {
  public:
    explicit QuadricCurvature(const Point& p) : MovedMesh(p, reference::Tessellation::regular) {}
    std::vector<float> measured() override { return curvature(estimated(PEL_CURVATURE_QUADRIC)); }
    std::vector<double> truth() override {
        std::vector<double> t;
        for (const auto& k : decided(mesh)) t.push_back(std::abs(k.mean()));
        return t;
    }
};

// How far the first direction lies off the true one, times the difference of the curvatures over the larger:
// where they are alike, any direction is right.
class PrincipalDirections : public MovedMesh {
  public:
    explicit PrincipalDirections(const Point& p) : MovedMesh(p, reference::Tessellation::regular) {
        for (const auto& k : decided(mesh)) before_.push_back(k);
    }
    std::vector<float> measured() override {
        const auto values = curvature(estimated(PEL_CURVATURE_QUADRIC, PEL_QUANTITY_FRAME), 8);
        std::vector<float> off;
        for (size_t i = 0; i < before_.size(); ++i)
            off.push_back(
                float(between(before_[i], {values[8 * i + 2], values[8 * i + 3], values[8 * i + 4]})));
        return off;
    }
    // Of the moved inputs against those before.
    std::vector<double> truth() override {
        std::vector<double> off;
        const auto now = decided(mesh);
        for (size_t i = 0; i < now.size(); ++i)
            off.push_back(std::isnan(now[i].first) || std::isnan(before_[i].first)
                              ? NAN
                              : between(before_[i], now[i].firstDirection));
        return off;
    }

  private:
    static double between(const reference::QuadricCurvature& k, reference::Vec3 direction) {
        const double largest = std::max(std::abs(k.first), std::abs(k.second));
        return largest > 0
                   ? reference::length(cross(k.firstDirection, direction)) * (k.first - k.second) / largest
                   : 0;
    }
    std::vector<reference::QuadricCurvature> before_;
};

class Normals : public MovedMesh {
    using MovedMesh::MovedMesh;
    std::vector<float> measured() override {
        const Buffer at(device(), positions), out(device(), count() * 12);
        topology.normals(vertexView(at, count()), vertexView(out, count()));
        return out.readAll<float>();
    }
    std::vector<double> truth() override {
        std::vector<double> t;
        for (const auto& n : reference::estimatedNormals(mesh)) t.insert(t.end(), {n.x, n.y, n.z});
        return t;
    }
};

class UvScale : public MovedMesh {
  public:
    explicit UvScale(const Point& p) : MovedMesh(p) {
        const double across = logBetween(p[4], 1e-6, 1e6);
        for (const auto& v : mesh.positions)
            uvs_.insert(uvs_.end(),
                        {float(across * std::sin(v.x / scale)), float(across * std::cos(v.y / scale))});
        place += text(", UVs %.2g across", across);
    }
    void move(Jitter& j) override {
        MovedMesh::move(j);
        j(uvs_);
    }
    std::vector<float> measured() override {
        const Buffer at(device(), positions), uvs(device(), uvs_);
        return {topology.uvScale(vertexView(at, count()), vertexView(uvs, count()))};
    }
    std::vector<double> truth() override {
        mesh.uvs.clear();
        for (size_t i = 0; i < uvs_.size(); i += 2) mesh.uvs.push_back({uvs_[i], uvs_[i + 1]});
        return {reference::uvScale(mesh)};
    }

  private:
    std::vector<float> uvs_;
};

template <class Of>
Operation mesh(const char* name, const tolerance::Tolerance& limit, Unit unit = Unit::largest,
               size_t dimensions = 4, const char* more = "", size_t points = 1000) {
    return operation({name, std::string(meshRange) + more, unit, limit, dimensions, points},
                     [](const Point& p) { return std::make_unique<Of>(p); });
}

}  // namespace

std::vector<Operation> meshOperations() {
    std::vector<Operation> all{
        mesh<EdgeCurvature>("curvature, edge", tolerance::edgeCurvature),
        mesh<QuadricCurvature>("curvature, quadric", tolerance::quadricCurvature, Unit::largest, 4,
                               "; regular triangles", 300),
        mesh<PrincipalDirections>("principal directions, quadric", tolerance::quadricCurvature,
                                  Unit::absolute, 4, "; regular triangles", 300),
        mesh<Normals>("normals", tolerance::stretchedNormals, Unit::absolute),
        mesh<UvScale>("UV scale", tolerance::uvScale, Unit::largest, 5, "; UVs of 1e-6 to 1e6 across")};
    const std::pair<const char*, PelCurvatureQuantity> quantities[] = {
        {"absolute mean", PEL_QUANTITY_ABSOLUTE}, {"absolute largest", PEL_QUANTITY_ABSOLUTE_MAX},
        {"curvedness", PEL_QUANTITY_CURVEDNESS},  {"mean", PEL_QUANTITY_MEAN},
        {"Gaussian", PEL_QUANTITY_GAUSSIAN},      {"first", PEL_QUANTITY_FIRST},
        {"second", PEL_QUANTITY_SECOND},          {"both principal", PEL_QUANTITY_PRINCIPAL}};
    for (const auto& [name, quantity] : quantities)
        all.push_back(operation({std::string("curvature, tensor: ") + name, meshRange, Unit::largest,
                                 tolerance::tensorCurvature, 4, 250},
                                [quantity = quantity](const Point& p) {
                                    return std::make_unique<TensorCurvature>(p, quantity);
                                }));
    for (Operation& o : all)
        if (o.header.name == "normals" || o.header.name.ends_with("Gaussian"))
            o.axis = Axis{2, 0.02, 1, "height over width"};
    return all;
}

}  // namespace stability
