// PelShader: keeps what the caller sets, plans a frame at commit, and runs its passes.
#pragma once
#include <deque>

#include "core/build_jobs.h"
#include "shading/material.h"
#include "shading/pass.h"
#include "shading/shading_constants.h"

namespace pel {

class BackgroundBuild;

class Shader final : public Object {
  public:
    static constexpr Kind kind = Kind::shader;
    // `passes`, in order, must outlive the shader.
    Shader(Ref<Device> device, std::span<const PassKind> passes);

    // shader_settings.cpp
    void setOptions(const PelShaderOptions& options);
    void setImage(PelImageSlot slot, const PelImageDesc* image);
    void setMaterial(uint32_t id, const PelMaterial* material, Lut* curvatureLut, Lut* shadowLut);
    void setNormalMap(uint32_t id, const PelImageDesc* levels, uint32_t count);
    void setScatteredTexture(uint32_t id, const PelImageDesc* texture);
    // Either may be NULL.
    void setEye(uint32_t id, const PelEye* eye, Lut* caustics);
    void setIrisTexture(uint32_t id, const PelImageDesc* texture);
    void setReflectionCube(const PelImageDesc* faces);
    void setEnvironment(const PelImageDesc* image, const float* axes);
    void setLights(const PelLight* lights, uint32_t count);
    void setLightImage(uint32_t light, PelLightSlot slot, const PelImageDesc* image);
    void setAmbient(const PelAmbient& ambient);
    void setAmbientCube(const PelImageDesc* faces);
    void setCamera(const PelCamera& camera);
    // The material as it is shaded. Throws for an id without a material.
    const PelMaterial& material(uint32_t id) const;

    // shader.cpp
    void commit();
    // `blocking`: the caller waits, and may want progress.
    void execute(bool blocking);
    PelShaderStats stats();
    // The passes that launched something in the newest finished execution, in order. Does not wait.
    std::vector<PelPassStats> passStats();
    std::vector<PelPassMemory> memory();
    // Warnings of the last commit, one sentence a line.
    const std::string& warnings() const { return warnings_; }
    // Jobs for a warm-up: they build the programs of a commit, and launch each kernel without tiles. Tables
    // of profiles are made here, those of eyes by a job; both are kept. The caller's images are not read,
    // except to count `autoPixels` (keepToBudget()) if it is 0. Throws the errors of a commit.
    void addBuildJobs(BuildJobs& jobs, uint64_t autoPixels = 0);
    Device& device() const { return *device_; }

  private:
    ~Shader() override;
    void commitState(const ShaderState& state, uint64_t& autoPixels);
    void commitStandIn();
    Ref<Shader> copy(const ShaderState& state) const;
    // `autoPixels`: see keepToBudget().
    ShaderPlan plan(const ShaderState& state, uint64_t& autoPixels);
    void allocate(ShaderPlan plan, uint32_t mostRows);
    ShaderMaterial& materialFor(uint32_t id, const char* what);
    template <class Check>
    void setView(ImageView& to, const PelImageDesc* image, const char* name, const Check& check);
    uint32_t methods() const;
    void checkMethods(const ShaderState& state) const;
    void finishPlan();
    void send();
    void beginOnNothing();
    void launchOnNothing(Pass& pass);
    void copyTextures(bool back) const;
    PassWork beginWork(bool codeAlone);
    void runPasses(PassWork& work, void (Pass::*part)(PassWork&));
    void runBand(PassWork& work);
    void setRows(const PassWork& work, TileRows rows);
    bool halveBand(bool blocking);

    Ref<Device> device_;
    std::span<const PassKind> passKinds_;
    ProfileTables profileTables_;
    ShaderState state_;  // as the caller set it
    ShaderPlan plan_;    // as of the last commit
    PassList passes_;
    ShadingConstants constants_;
    cl::Memory counters_;
    // At which images of passes begin, in the device's constants; empty: it has to be written.
    std::optional<uint32_t> scratchRow_ = 0;
    std::string warnings_;
    bool committed_ = false, executed_ = false;
    std::unique_ptr<BackgroundBuild> background_;
    bool standsIn_ = false;  // the committed state is a substitute
    bool captureAsked_ = false;
    uint64_t bands_ = 0, programsBuilt_ = 0, launches_ = 0, bytesUploaded_ = 0, uploadedBefore_ = 0;

    // An execution: its launches in order, and which of them are a pass's, from `begin` to the next part's.
    struct Frame {
        struct Part {
            size_t pass, begin;
            uint64_t tiles;
        };
        uint64_t number = 0;
        std::vector<cl::Event> events;
        std::vector<Part> parts;
    };
    uint64_t ownBytes() const;
    bool hasFinished(const Frame& frame) const;
    uint64_t executions_ = 0;
    std::deque<Frame> frames_;  // those in flight, and before them the newest that has finished
};

}  // namespace pel
