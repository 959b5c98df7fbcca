// A library to preload into any program: it counts the kernels that libtorch's operations would launch on CUDA.
//
// An operation of the table below counts, forwards or backwards, unless it is part of another counted operation.
// Views, allocations and composite operations launch nothing themselves. Where one operation launches several
// kernels on CUDA, the count is a lower bound.
#include <ATen/record_function.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>

namespace {

const char* const COUNTED[] = {
    "aten::_softmax", "aten::_softmax_backward_data", "aten::_scaled_dot_product_flash_attention_for_cpu",
    "aten::_scaled_dot_product_flash_attention_for_cpu_backward", "aten::add", "aten::add_", "aten::addcdiv_",
    "aten::addmm", "aten::all", "aten::arange", "aten::baddbmm", "aten::bmm", "aten::cat", "aten::clamp_max",
    "aten::clamp_min", "aten::copy_", "aten::cumsum", "aten::div", "aten::div_", "aten::eq", "aten::fill_",
    "aten::ge", "aten::index_add_", "aten::index_select", "aten::lerp_", "aten::linalg_vector_norm", "aten::lt",
    "aten::masked_fill", "aten::masked_fill_", "aten::mean", "aten::mm", "aten::mul", "aten::mul_",
    "aten::native_layer_norm", "aten::native_layer_norm_backward", "aten::neg", "aten::pow", "aten::random_",
    "aten::reciprocal", "aten::rsub", "aten::sqrt", "aten::sub", "aten::sub_", "aten::sum",
    "aten::threshold_backward", "aten::zero_"};

std::mutex mutex;
std::map<std::string, long> counts;
thread_local int inside = 0;

bool is_counted(const char* name) {
  for (const char* counted : COUNTED) {
    if (std::strcmp(name, counted) == 0) return true;
  }
  return false;
}

struct Within : at::ObserverContext {};

std::unique_ptr<at::ObserverContext> begin(const at::RecordFunction& function) {
  if (!is_counted(function.name())) return nullptr;
  if (inside++ == 0) {
    std::lock_guard<std::mutex> guard(mutex);
    ++counts[function.name()];
  }
  return std::make_unique<Within>();
}

void end(const at::RecordFunction&, at::ObserverContext* context) {
  if (context != nullptr) --inside;
}

struct Report {
  Report() {
    at::addGlobalCallback(at::RecordFunctionCallback(begin, end).scopes({at::RecordScope::FUNCTION}));
  }
  ~Report() {
    const char* path = std::getenv("OPERATIONS");
    FILE* file = path == nullptr ? nullptr : std::fopen(path, "w");
    if (file == nullptr) return;
    long sum = 0;
    for (const auto& entry : counts) {
      std::fprintf(file, "%8ld %s\n", entry.second, entry.first.c_str());
      sum += entry.second;
    }
    std::fprintf(file, "%8ld in all\n", sum);
    std::fclose(file);
  }
} report;

}  // namespace
