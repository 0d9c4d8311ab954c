// Profile files, the library of materials, and fits of Gaussians.
#include "io/file_error.h"
#include "io/lut/profile_file.h"
#include "io_files.h"
#include "profile_fit/profile_fit.h"

using namespace pellucid;

const std::string head = "name = \"x\"\nsource = \"here\"\nunit = \"cm\"\n";  // three lines

TEST(ProfileFile, EveryMaterialOfTheLibraryLoads) {
    ASSERT_GE(Profile::libraryNames().size(), 9u);
    EXPECT_EQ(Profile::libraryNames()[0], "skin");
    EXPECT_EQ(pelProfileLibraryName(1000), nullptr);
    for (const std::string& name : Profile::libraryNames()) {
        const io::ProfileFile file = io::findProfile(name);
        EXPECT_EQ(file.name, name);
        EXPECT_FALSE(file.source.empty()) << name;
        const PelProfileInfo info = file.profile.info();
        EXPECT_EQ(info.name, name);
        EXPECT_GT(info.radius, 0) << name;
        EXPECT_EQ(*std::max_element(info.normalBlend, info.normalBlend + 3), 1) << name;
        // Red light goes furthest in all of them but jade and cream's kin; energy is 1 everywhere.
        std::vector<double> at;
        for (int i = 0; i < 4000; ++i) at.push_back(info.radius * std::exp(-14 + 17.5 * (i + 0.5) / 4000));
        const auto P = file.profile.lineSpread(at);
        for (int c = 0; c < 3; ++c) {
            double energy = 0;
            for (size_t i = 0; i < at.size(); ++i) energy += 2 * P[3 * i + c] * at[i] * 17.5 / 4000;
            EXPECT_NEAR(energy, 1, tolerance::sampledEnergy) << name << " channel " << c;
        }
    }
    EXPECT_THROW(io::findProfile("granite"), io::FileError);
    EXPECT_THROW(io::findProfile("no-such-file.toml"), io::FileError);
}

TEST(ProfileFile, UnitsBecomeMillimetres) {
    const auto centimetres = io::parseProfile(
        "p", head + "kind = \"gaussians\"\n[[gaussian]]\nvariance = 0.04\nweight = [1, 1, 1]\n");
    EXPECT_NEAR(centimetres.profile.info().radius, 2, tolerance::profileEvaluation);
    const auto metres =
        io::parseProfile("p",
                         "name=\"m\"\nsource=\"s\"\nunit=\"m\"\nkind=\"dipole\"\nabsorption=[2.1, 4.1, 7.1]\n"
                         "reduced_scattering=[2190, 2620, 3000]\neta=1.5\n");
    EXPECT_NEAR(metres.profile.info().radius / io::findProfile("marble").profile.info().radius, 1,
                tolerance::profileEvaluation);
    const auto table =
        io::parseProfile("p", head +
                                  "kind = \"table\"\n[[sample]]\ndistance = 0\nvalue = [1, 1, 1]\n"
                                  "[[sample]]\ndistance = 0.3\nvalue = [0, 0, 0]\n");
    EXPECT_EQ(table.profile.info().kind, PEL_PROFILE_TABLE);
    EXPECT_EQ(table.profile.radial({3.5})[0], 0);
    EXPECT_GT(table.profile.radial({2.9})[0], 0);
}

TEST(ProfileFile, TextOfARecipeIsReadAsTheSameProfile) {
    pel::ProfileRecipe recipe;
    recipe.kind = PEL_PROFILE_DIPOLE;
    recipe.name = "d";
    std::copy_n(std::array{0.03f, 0.1f, 0.5f}.begin(), 3, recipe.first);
    std::copy_n(std::array{0.9f, 1.5f, 2.0f}.begin(), 3, recipe.second);
    recipe.eta = 1.3f;
    const Profile read = io::parseProfile("p", io::profileText(recipe)).profile;
    EXPECT_EQ(read.radial({0.1, 1, 3}),
              Profile::dipole(recipe.first, recipe.second, recipe.eta).radial({0.1, 1, 3}));
    recipe.kind = PEL_PROFILE_BURLEY;
    recipe.byDistance = true;
    const Profile byDistance = io::parseProfile("p", io::profileText(recipe)).profile;
    EXPECT_EQ(byDistance.radial({1}), Profile::burleyDistance(recipe.first).radial({1}));
}

TEST(ProfileFile, MistakesHaveTheirLine) {
    const struct {
        std::string text;
        const char *line, *word;
    } rows[] = {
        {"name = ", "p.toml:1: ", "TOML"},
        {head, "p.toml:1: ", "'kind'"},
        {head + "kind = \"glass\"\n", "p.toml:4: ", "'glass'"},
        {head + "kind = \"burley\"\n", "p.toml:1: ", "mean_free_path"},
        {head + "kind = \"burley\"\nmean_free_path = [1, 2]\nalbedo = [0, 0, 0]\n",
         "p.toml:5: ", "3 numbers"},
        {head + "kind = \"burley\"\nmean_free_path = [1, 2, -3]\nalbedo = [0, 0, 0]\n",
         "p.toml:5: ", "more than 0"},
        {head + "kind = \"skin\"\ncolour = 3\n", "p.toml:5: ", "colour"},
        {head + "kind = \"skin\"\nmelanin = 0.6\n", "p.toml:5: ", "melanin"},
        {head + "kind = \"gaussians\"\n[[gaussian]]\nvariance = 1\nweight = [1, 1, 0]\n",
         "p.toml:1: ", "blue"},
        {"name=\"x\"\nsource=\"s\"\nkind=\"dipole\"\n", "p.toml:1: ", "unit"},
    };
    for (const auto& row : rows) {
        const std::string said = messageOf<io::FileError>([&] { io::parseProfile("p.toml", row.text); });
        EXPECT_TRUE(contains(said, row.line) && contains(said, row.word)) << said;
    }
}

// The printed values are those of the saved file: weights of 1 per channel, and the loaded profile's error,
// which more Gaussians make smaller.
TEST(ProfileFit, TheSavedFileHasThePrintedError) {
    for (const char* name : {"marble", "skin", "skin-burley", "ketchup"}) {
        const Profile profile = io::findProfile(name).profile;
        double before = 1;
        for (int count : {1, 2, 3, 6}) {
            const io::ProfileFit fit = io::fitGaussians(profile, count);
            const double error = *std::max_element(fit.error, fit.error + 3);
            EXPECT_LT(error, before) << name << " " << count;
            before = error;
            for (int c = 0; c < 3; ++c) {
                double sum = 0;
                for (const PelGaussian& g : fit.gaussians) sum += g.weight[c];
                EXPECT_NEAR(sum, 1, tolerance::floatWeights) << name << " " << count << " channel " << c;
            }
            const auto loaded = io::parseProfile("fit", io::profileText(fit, "again", "a test"));
            const double first = 1e-3 * profile.info().radius, step = std::log(15e3) / 399;
            std::vector<double> at;
            for (int i = 0; i < 400; ++i) at.push_back(first * std::exp(i * step));
            const auto P = profile.lineSpread(at), Q = loaded.profile.lineSpread(at);
            for (size_t c = 0; c < 3; ++c) {
                double squares = 0, norm = 0;
                for (size_t i = 0; i < 400; ++i) {
                    squares += at[i] * std::pow(P[3 * i + c] - Q[3 * i + c], 2);
                    norm += at[i] * P[3 * i + c] * P[3 * i + c];
                }
                EXPECT_NEAR(fit.error[c], std::sqrt(squares / norm), tolerance::profileEvaluation)
                    << name << " " << count << " channel " << c;
            }
        }
        EXPECT_LT(before, 1.1 * tolerance::sixGaussians) << name;
    }
    EXPECT_THROW(io::fitGaussians(Profile::skin(), 0), std::invalid_argument);
}

TEST(ProfileFit, SixGaussiansGiveSkinBack) {
    const double sigma[6] = {0.080, 0.220, 0.432, 0.753, 1.411, 2.722};
    const double weight[6][3] = {{.233, .455, .649}, {.100, .336, .344}, {.118, .198, 0},
                                 {.113, .007, .007}, {.358, .004, 0},    {.078, 0, 0}};
    const io::ProfileFit fit = io::fitGaussians(Profile::skin(), 6);
    ASSERT_EQ(fit.gaussians.size(), 6u);
    for (size_t g = 0; g < 6; ++g) {
        EXPECT_NEAR(fit.gaussians[g].variance / (sigma[g] * sigma[g]), 1, tolerance::fittedAgain) << g;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(fit.gaussians[g].weight[c], weight[g][c], tolerance::fittedAgain) << g;
    }
    EXPECT_LT(*std::max_element(fit.error, fit.error + 3), tolerance::floatWeights);
}

TEST(ProfileFile, SkinThatSaysWhatItIsMadeOfIsComputed) {
    const std::string skin = "name = \"cheek\"\nsource = \"here\"\nkind = \"skin\"\n";
    EXPECT_EQ(io::parseProfile("p.toml", skin).profile.info().kind, PEL_PROFILE_SKIN);
    PelSkin own = pelSkinDefaults();
    own.melanin = 0.2f;
    own.oxygenation = 0.5f;
    const io::ProfileFile file = io::parseProfile("p.toml", skin + "melanin = 0.2\noxygenation = 0.5\n");
    EXPECT_EQ(file.kind, "skin-layers");
    EXPECT_EQ(file.profile.info().radius, Profile::skinLayers(own).info().radius);
}
