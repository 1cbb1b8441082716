#include "formats/direction_table.h"

#include "formats/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace faceta {

namespace {

constexpr double kLengthTolerance = 1e-3;

std::string text_of(double value) {
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, static_cast<float>(value)).ptr};
}

void complain(CsvRows& rows, int row, int input, std::string message, std::string hint) {
  if (!rows.complaint || row < rows.complaint->row)
    rows.complaint = {row, input, std::move(message), std::move(hint)};
}

/// The inputs first, first + 1 and first + 2 must be a unit vector.
void check_directions(CsvRows& rows, int first, const std::string& name) {
  const float* v[3];
  for (size_t k = 0; k < 3; ++k)
    v[k] = rows.input[static_cast<size_t>(first) + k].data();
  for (int i = 0; i < rows.count; ++i) {
    double x = v[0][i], y = v[1][i], z = v[2][i];
    double length = std::sqrt(x * x + y * y + z * z);
    if (std::abs(length - 1) < kLengthTolerance)
      continue;
    complain(rows, i, first, name + " has the length " + text_of(length),
             "directions are unit vectors");
    return;
  }
}

/// The input must be a number in [0, 1], of which 1 becomes the float before it.
void check_uniform(CsvRows& rows, int input, const std::string& name) {
  for (int i = 0; i < rows.count; ++i) {
    float& u = rows.input[static_cast<size_t>(input)][static_cast<size_t>(i)];
    if (!(u >= 0 && u <= 1)) {
      complain(rows, i, input, name + " is " + text_of(u), "allowed: from 0 to 1");
      return;
    }
    u = std::min(u, std::nextafter(1.0f, 0.0f));
  }
}

void copy(const std::vector<float>& from, std::vector<float>& to) {
  std::copy(from.begin(), from.end(), to.begin());
}
void copy_results(const std::vector<float>& from, std::vector<float>& to) {
  std::copy_n(from.begin(), to.size(), to.begin());
}

void eval_rows(const ColumnMaterial& material, CsvRows& rows) {
  check_directions(rows, 0, "wo");
  check_directions(rows, 3, "wi");
  if (rows.complaint)
    return;
  EvalColumns columns(rows.count);
  for (size_t k = 0; k < 3; ++k) {
    copy(rows.input[k], columns.wo[k]);
    copy(rows.input[3 + k], columns.wi[k]);
  }
  copy(rows.input[6], columns.uv[0]);
  copy(rows.input[7], columns.uv[1]);
  material.eval(columns);
  for (size_t k = 0; k < 3; ++k)
    copy_results(columns.value[k], rows.output[k]);
  copy_results(columns.pdf, rows.output[3]);
}

/// Position in the words of the column lobe.
float lobe_word(int32_t flags) {
  switch (flags & kLobeMask) {
  case kReflection:
    return 1;
  case kTransmission:
    return 2;
  case kNullLobe:
    return 3;
  default:
    return 0;
  }
}

void write_samples(const SampleColumns& columns, CsvRows& rows) {
  for (size_t i = 0; i < static_cast<size_t>(rows.count); ++i) {
    if (!(columns.flags[i] & kValidFlag))
      continue;
    for (size_t k = 0; k < 3; ++k) {
      rows.output[k][i] = columns.wi[k][i];
      rows.output[3 + k][i] = columns.weight[k][i];
    }
    rows.output[6][i] = columns.pdf[i];
    rows.output[7][i] = lobe_word(columns.flags[i]);
    rows.output[8][i] = (columns.flags[i] & kDeltaFlag) ? 1 : 0;
  }
}

void sample_rows(const ColumnMaterial& material, CsvRows& rows) {
  check_directions(rows, 0, "wo");
  check_uniform(rows, 3, "u1");
  check_uniform(rows, 4, "u2");
  check_uniform(rows, 5, "uc");
  if (rows.complaint)
    return;
  SampleColumns columns(rows.count);
  for (size_t k = 0; k < 3; ++k)
    copy(rows.input[k], columns.wo[k]);
  copy(rows.input[3], columns.u[0]);
  copy(rows.input[4], columns.u[1]);
  copy(rows.input[5], columns.uc);
  copy(rows.input[6], columns.uv[0]);
  copy(rows.input[7], columns.uv[1]);
  material.sample(columns);
  write_samples(columns, rows);
}

} // namespace

void eval_table(const ColumnMaterial& material, const std::string& source,
                const std::string& target) {
  const std::vector<CsvInput> inputs = {{"wo_x", {}}, {"wo_y", {}}, {"wo_z", {}}, {"wi_x", {}},
                                        {"wi_y", {}}, {"wi_z", {}}, {"u", 0.5f},  {"v", 0.5f}};
  const std::vector<CsvOutput> outputs = {
      {"value_r", {}}, {"value_g", {}}, {"value_b", {}}, {"pdf", {}}};
  transform_csv(source, target, inputs, outputs, [&](CsvRows& rows) { eval_rows(material, rows); });
}

void sample_table(const ColumnMaterial& material, const std::string& source,
                  const std::string& target) {
  const std::vector<CsvInput> inputs = {{"wo_x", {}}, {"wo_y", {}}, {"wo_z", {}}, {"u1", {}},
                                        {"u2", {}},   {"uc", {}},   {"u", 0.5f},  {"v", 0.5f}};
  const std::vector<CsvOutput> outputs = {
      {"wi_x", {}},         {"wi_y", {}},
      {"wi_z", {}},         {"weight_r", {}},
      {"weight_g", {}},     {"weight_b", {}},
      {"pdf", {}},          {"lobe", {"none", "reflection", "transmission", "null"}},
      {"delta", {"0", "1"}}};
  transform_csv(source, target, inputs, outputs,
                [&](CsvRows& rows) { sample_rows(material, rows); });
}

} // namespace faceta
