#pragma once

/// The binary interface between the baseline library and the per-instruction-set modules: plain
/// structs of pointers, no templates, no exceptions.

#include <cstdint>

namespace faceta {

/// Every array that a kernel reads or writes has room for this many values past its end.
inline constexpr int kLanePadding = 16;

/// Textured slots a program can have (bits of MaterialArgs::textured).
inline constexpr int kMaxSlots = 64;

/// The parameters of n lanes: a program is a model with its choices; lanes may belong to different
/// materials of that program, whose records are gathered.
struct MaterialArgs {
  const float* records = nullptr;   ///< slot k of record r is records[r * stride + k]
  int32_t stride = 0;               ///< floats per record
  const int32_t* choices = nullptr; ///< the model's choices and flags, the same for all lanes
  const float* tables = nullptr;    ///< arena that the records' table offsets point into
  uint64_t textured = 0;            ///< slots taken from lane_slots instead of the record
  const float* const* lane_slots = nullptr; ///< per slot: one value a lane (null unless textured)
  const int32_t* rows = nullptr;            ///< record of each lane; null: all lanes use record 0
  int32_t importance = 0;                   ///< 1: transport of importance instead of radiance
};

struct EvalArrays {
  const float *wo[3], *wi[3], *uv[2];
  float* value[3];
  float* pdf;
};

/// flags: lobe | kDeltaFlag | kValidFlag
inline constexpr int32_t kDeltaFlag = 8, kValidFlag = 16, kLobeMask = 7;

struct SampleArrays {
  const float *wo[3], *u[2], *uc, *uv[2];
  float *wi[3], *value[3], *pdf, *weight[3], *eta;
  int32_t* flags;
};

/// One model in one instruction set.
struct MaterialKernel {
  const char* name;
  void (*eval)(const MaterialArgs&, const EvalArrays&, int n);
  void (*sample)(const MaterialArgs&, const SampleArrays&, int n);
  /// Both for the same wo, sharing the parameters: what the renderer calls.
  void (*eval_sample)(const MaterialArgs&, const EvalArrays&, const SampleArrays&, int n);
};

struct RenderKernels;

/// What a module exports through its one C symbol, faceta_module_table.
struct ModuleTable {
  int32_t abi;        ///< kModuleAbi
  int32_t lane_width; ///< 1, 8 or 16
  const char* isa;    ///< "scalar", "v3" or "v4"
  int32_t kernel_count;
  const MaterialKernel* const* kernels;
  const RenderKernels* render; ///< null in modules that carry materials only
};

inline constexpr int32_t kModuleAbi = 1;

} // namespace faceta
