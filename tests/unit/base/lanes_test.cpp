// Lanes of every instruction set against float, bit for bit, for every function of the number
// types.

#include "lanes_module/lane_functions.h"

#include <bit>
#include <cmath>
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace faceta::test {
namespace {

bool supported(const std::string& isa) {
  __builtin_cpu_init();
  if (isa == "scalar")
    return true;
  bool extras = __builtin_cpu_supports("aes") && __builtin_cpu_supports("pclmul");
  return extras &&
         (isa == "v3" ? __builtin_cpu_supports("x86-64-v3") : __builtin_cpu_supports("x86-64-v4"));
}

const LaneTable& load_table(const std::string& isa) {
  std::string path = std::string(FACETA_LANE_MODULES) + "/lanes_" + isa + ".so";
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle)
    throw std::runtime_error(dlerror());
  return *reinterpret_cast<const LaneTable* (*)()>(dlsym(handle, "faceta_module_table"))();
}

// All pairs of special numbers, then random ones of every size, then random bits.
struct Inputs {
  std::vector<float> a, b, c;
  Inputs() {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::nanf("");
    std::vector<float> special = {0.0f,      -0.0f,  1.0f,    -1.0f,    0.5f,      -2.0f,  inf,
                                  -inf,      nan,    1e-45f,  -1e-45f,  1e-40f,    3e38f,  -3e38f,
                                  0x1p-126f, 1e-30f, 0.9999f, 1.00001f, 1.570796f, 89.0f,  -104.0f,
                                  16777216,  0.25f,  -0.75f,  3.14159f, 1e4f,      0.333f, -17.5f};
    for (float x : special)
      for (float y : special)
        for (float z : {1.5f, 0.0f, nan, -inf})
          push(x, y, z);
    std::mt19937 random(1);
    auto number = [&] {
      float m = std::uniform_real_distribution<float>(-1, 1)(random);
      return std::ldexp(m, std::uniform_int_distribution<int>(-20, 20)(random));
    };
    for (int i = 0; i < 20000; ++i)
      push(number(), number(), number());
    std::uniform_real_distribution<float> unit(-1, 1);
    for (int i = 0; i < 10000; ++i)
      push(unit(random), unit(random), unit(random));
    for (int i = 0; i < 20000; ++i)
      push(std::bit_cast<float>(uint32_t(random())), std::bit_cast<float>(uint32_t(random())),
           std::bit_cast<float>(uint32_t(random())));
    while (a.size() % 16)
      push(1, 2, 3);
  }
  void push(float x, float y, float z) {
    a.push_back(x);
    b.push_back(y);
    c.push_back(z);
  }
  int size() const { return static_cast<int>(a.size()); }
};
const Inputs& inputs() {
  static const Inputs i;
  return i;
}

bool same(float x, float y) {
  return std::bit_cast<uint32_t>(x) == std::bit_cast<uint32_t>(y) || (x != x && y != y);
}

class LanesOf : public ::testing::TestWithParam<const char*> {
protected:
  void SetUp() override {
    if (!supported(GetParam()))
      GTEST_SKIP() << "this CPU does not run " << GetParam();
    table = &load_table(GetParam());
  }
  const LaneTable* table = nullptr;
};

TEST_P(LanesOf, HaveTheirWidth) {
  std::string isa = GetParam();
  EXPECT_EQ(table->width, isa == "v4" ? 16 : isa == "v3" ? 8 : 1);
}

TEST_P(LanesOf, EveryFunctionGivesTheBitsOfFloat) {
  const Inputs& in = inputs();
  const LaneTable& reference = LaneLoops<float>::table();
  ASSERT_EQ(table->count, reference.count);
  std::vector<float> expected(in.size() + 16), found(in.size() + 16);
  for (int f = 0; f < table->count; ++f) {
    reference.functions[f].run(in.a.data(), in.b.data(), in.c.data(), expected.data(), in.size());
    table->functions[f].run(in.a.data(), in.b.data(), in.c.data(), found.data(), in.size());
    int wrong = 0;
    for (int i = 0; i < in.size() && wrong < 3; ++i)
      if (!same(expected[i], found[i])) {
        ++wrong;
        ADD_FAILURE() << reference.functions[f].name << "(" << in.a[i] << ", " << in.b[i] << ", "
                      << in.c[i] << ") is " << found[i] << " instead of " << expected[i];
      }
  }
}

TEST_P(LanesOf, MasksTellTheirLanes) {
  const Inputs& in = inputs();
  int groups = in.size() / table->width;
  std::vector<int32_t> words(groups * 6);
  table->masks(in.a.data(), in.b.data(), words.data(), in.size());
  for (int g = 0; g < groups; ++g) {
    uint32_t bits = 0;
    for (int i = 0; i < table->width; ++i)
      bits |= uint32_t(in.a[g * table->width + i] < in.b[g * table->width + i]) << i;
    const int32_t* w = &words[g * 6];
    uint32_t full = table->width == 32 ? ~0u : (1u << table->width) - 1;
    ASSERT_EQ(w[0], bits != 0);
    ASSERT_EQ(w[1], bits == full);
    ASSERT_EQ(w[2], bits == 0);
    ASSERT_EQ(w[3], std::popcount(bits));
    ASSERT_EQ(uint32_t(w[4]), bits);
    ASSERT_EQ(uint32_t(w[5]), bits);
  }
}

TEST_P(LanesOf, CompressStoreKeepsOrder) {
  const Inputs& in = inputs();
  std::vector<float> expected, found(in.size() + 16);
  std::vector<int32_t> found_int(in.size() + 16);
  for (int i = 0; i < in.size(); ++i)
    if (in.a[i] < in.b[i])
      expected.push_back(in.a[i]);
  int count = table->compress(in.a.data(), in.b.data(), found.data(), found_int.data(), in.size());
  ASSERT_EQ(count, int(expected.size()));
  for (int i = 0; i < count; ++i) {
    ASSERT_TRUE(same(found[i], expected[i])) << i;
    ASSERT_EQ(found_int[i], std::bit_cast<int32_t>(expected[i])) << i;
  }
}

TEST_P(LanesOf, GatherAndLoad) {
  const int n = 4096;
  std::mt19937 random(2);
  std::vector<float> values(n), floats(n);
  std::vector<int32_t> indices(n), ints(n);
  for (int i = 0; i < n; ++i) {
    values[i] = float(i) * 0.25f;
    indices[i] = int32_t(random() % n);
  }
  table->memory(values.data(), indices.data(), floats.data(), ints.data(), n);
  for (int i = 0; i < n; ++i) {
    ASSERT_EQ(floats[i], values[indices[i]]) << i;
    ASSERT_EQ(ints[i], indices[indices[i]] + i) << i;
  }
}

TEST_P(LanesOf, PairsOfNeighbours) {
  const int n = 4096;
  std::mt19937 random(3);
  std::vector<float> values(n + 1), expected, found(4 * n + 2 * 16);
  std::vector<int32_t> indices(n);
  std::iota(values.begin(), values.end(), 0.0f);
  for (int32_t& i : indices)
    i = int32_t(random() % n);
  for (bool all : {true, false})
    for (int32_t i : indices)
      if (all || i % 2)
        expected.insert(expected.end(), {values[i], values[i + 1]});
  int count = table->pairs(values.data(), indices.data(), found.data(), n);
  ASSERT_EQ(size_t(2 * count), expected.size());
  found.resize(expected.size());
  EXPECT_EQ(found, expected);
}

TEST_P(LanesOf, FirstLanes) {
  for (int n = 0; n <= table->width; ++n)
    EXPECT_EQ(table->first(n), (1u << n) - 1) << n;
}

INSTANTIATE_TEST_SUITE_P(Isa, LanesOf, ::testing::Values("scalar", "v3", "v4"),
                         [](const auto& info) { return std::string(info.param); });

} // namespace
} // namespace faceta::test
