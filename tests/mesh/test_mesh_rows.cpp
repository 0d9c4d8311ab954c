// How kernels read the rows of a mesh: runs of neighbours in one load, and the last vertex of packed data,
// behind which there is no memory.
#include <sys/mman.h>
#include <unistd.h>

#include "mesh_fixture.h"

using namespace fixture;
using namespace pellucid;

namespace {

// Memory whose end is the end of what the process may touch: reading one byte more is a segmentation fault.
class Fenced {
  public:
    explicit Fenced(const std::vector<float>& values) : page_(size_t(sysconf(_SC_PAGESIZE))) {
        const size_t bytes = values.size() * sizeof(float);
        size_ = (bytes + page_ - 1) / page_ * page_ + page_;
        map_ = static_cast<char*>(
            mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
        if (map_ == MAP_FAILED) throw std::runtime_error("mmap");
        data_ = map_ + (size_ - page_ - bytes);
        std::memcpy(data_, values.data(), bytes);
        if (mprotect(map_ + size_ - page_, page_, PROT_NONE)) throw std::runtime_error("mprotect");
    }
    Fenced(const Fenced&) = delete;
    ~Fenced() { munmap(map_, size_); }
    char* data() const { return data_; }

  private:
    size_t page_, size_;
    char *map_, *data_;
};

// Every pass that reads positions or normals by slot.
std::vector<PelCurvatureParams> everyPass() {
    std::vector<PelCurvatureParams> all;
    for (auto estimator : allEstimators) {
        PelCurvatureParams params = paramsOf(estimator, 3);
        all.push_back(params);
        params.smoothingPasses = 0;
        params.smoothingRadius = 0.5f;
        params.smoothingCrease = 1.0f;
        params.smoothingStages = 8;
        all.push_back(params);
    }
    return all;
}

// Results of every pass, with the normals given and with made ones, one after the other; of the first `count`
// vertices.
std::vector<float> everything(const MeshTopology& topology, const Buffer& positions, const Buffer& normals,
                              uint32_t n, uint32_t count) {
    std::vector<float> all;
    for (const PelCurvatureParams& params : everyPass())
        for (bool made : {false, true}) {
            const Buffer out(device(), n * sizeof(float));
            made ? topology.curvature(params, vertexView(positions, n), vertexView(out, n))
                 : topology.curvature(params, vertexView(positions, n), vertexView(normals, n),
                                      vertexView(out, n));
            const std::vector<float> values = out.readAll<float>();
            all.insert(all.end(), values.begin(), values.begin() + count);
        }
    return all;
}

std::vector<float> everything(const Mesh& mesh, uint32_t count) {
    const MeshTopology topology(device(), topologyDesc(mesh));
    const Buffer positions(device(), mesh.positions), normals(device(), mesh.normals);
    return everything(topology, positions, normals, mesh.vertices(), count);
}

}  // namespace

TEST(MeshRows, NothingBehindTheLastVertexIsRead) {
    // Whole last slices and others, in an order with runs and in one without.
    for (uint32_t sides : {40u, 41u, 42u, 43u})
        for (bool shuffled : {false, true}) {
            Mesh mesh = torus(5, sized(sides, sides - 32));
            if (shuffled) mesh = shuffleVertices(mesh, sides).mesh;
            const uint32_t n = mesh.vertices();
            // With one more vertex without triangles, the others' last vertex is not the last in memory.
            Mesh longer = mesh;
            longer.vertex({1, 2, 3});
            const std::vector<float> expected = everything(longer, n);

            const Fenced positions(mesh.positions), normals(mesh.normals);
            const MeshTopology topology(device(), topologyDesc(mesh));
            const Buffer p = Buffer::fromHost(device(), positions.data(), n * 12),
                         q = Buffer::fromHost(device(), normals.data(), n * 12);
            EXPECT_EQ(everything(topology, p, q, n, n), expected) << n << (shuffled ? " shuffled" : "");
        }
}

TEST(MeshRows, RunsGiveTheBitsOfSingleLoads) {
    // A grid consists mostly of runs. A larger part without runs is appended, so that the topology keeps
    // none: the rows of the grid are the same, but are read one by one.
    const Mesh grid = torus(sized(24, 8), sized(40, 8));
    Mesh both = grid;
    both.append(shuffleVertices(torus(sized(40, 10), sized(40, 10)), 3).mesh);
    ASSERT_EQ(grid.vertices() % 8, 0u);
    const std::vector<float> alone = everything(grid, grid.vertices());
    EXPECT_EQ(alone, everything(both, grid.vertices()));

    const auto allocated = [] { return device().stats().bytesAllocated; };
    const uint64_t before = allocated();
    const std::vector<char> bytes = MeshTopology(device(), topologyDesc(grid)).save();
    const uint64_t between = allocated();
    const MeshTopology loaded = MeshTopology::load(device(), bytes.data(), bytes.size());
    EXPECT_EQ(allocated() - between, between - before) << "the same lists, with runs";
    const Buffer positions(device(), grid.positions), normals(device(), grid.normals);
    EXPECT_EQ(everything(loaded, positions, normals, grid.vertices(), grid.vertices()), alone);
}
