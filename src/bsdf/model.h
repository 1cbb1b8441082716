#pragma once

/// The visitors that move a model's numbers: from a record into the fields of any number type, and
/// from the double reference back into a record.

#include "bsdf/describe.h"
#include "bsdf/kernel.h"

namespace faceta {

/// Common part of the visitors that walk the float slots and integer choices in order. D offers
/// number(T&) and word(int&).
template <class D, class M, class T> struct FieldVisitor : DescribeIgnoringTexts<D> {
  using Words = std::initializer_list<const char*>;
  using DescribeIgnoringTexts<D>::self;
  M& m;
  explicit FieldVisitor(M& model) : m(model) {}

  FACETA_INLINE D& number_field(T M::* f) {
    self().number_at(m.*f);
    return self();
  }
  FACETA_INLINE D& color_field(Color<T> M::* f) {
    for (int i = 0; i < Color<T>::size(); ++i)
      self().number_at((m.*f)[i]);
    return self();
  }
  FACETA_INLINE D& reflectance(const char*, Color<T> M::* f, const char*) {
    return self().color_field(f);
  }
  FACETA_INLINE D& spectrum(const char*, Color<T> M::* f, Range, const char*) {
    return self().color_field(f);
  }
  FACETA_INLINE D& scalar(const char*, T M::* f, Range, Range, const char*, const char*) {
    return number_field(f);
  }
  FACETA_INLINE D& number(const char*, T M::* f, Range, Range, const char*, const char*) {
    return number_field(f);
  }
  FACETA_INLINE D& ior(const char*, T M::* f, const char*, const char*) { return number_field(f); }
  FACETA_INLINE D& roughness(T M::* u, T M::* v, const char*) {
    number_field(u);
    return number_field(v);
  }
  FACETA_INLINE D& choice(const char*, int M::* f, Words, const char*) {
    self().choice_at(m.*f);
    return self();
  }
  FACETA_INLINE D& flag(const char*, int M::* f, const char*) {
    self().choice_at(m.*f);
    return self();
  }
  FACETA_INLINE D& file(const char*, const float* M::* f, const char*) {
    self().file_at(m.*f);
    return self();
  }
  FACETA_INLINE void file_at(const float*&) {}
  FACETA_INLINE D& derived(T M::* f) { return number_field(f); }
  FACETA_INLINE D& derived(Color<T> M::* f) { return self().color_field(f); }
  FACETA_INLINE D& table(Table<T> M::* f) {
    self().table_at(m.*f);
    return self();
  }
};

/// Fills a model from MaterialArgs: from the common record, gathered from several, or from
/// textures.
template <class M, class T, class Choices> struct RecordLoader
    : FieldVisitor<RecordLoader<M, T, Choices>, M, T> {
  const MaterialArgs& args;
  Choices choices;
  IntOf<T> offset; ///< rows * stride
  bool common;     ///< all lanes use the record at args.records + first
  int32_t first;
  int position; ///< index of the first lane in the lane arrays
  int slot = 0, choice_index = 0;

  FACETA_INLINE RecordLoader(M& m, const MaterialArgs& a, Choices c, int lane_position)
      : FieldVisitor<RecordLoader, M, T>(m), args(a), choices(c), offset(0),
        common(a.rows == nullptr), first(0), position(lane_position) {
    if (!common) {
      IntOf<T> rows = load_int<T>(a.rows + lane_position);
      offset = rows * IntOf<T>(a.stride);
      common = all(rows == IntOf<T>(a.rows[lane_position]));
      first = a.rows[lane_position] * a.stride;
    }
  }
  FACETA_INLINE void number_at(T& field) {
    int k = slot++;
    if ((args.textured >> k) & 1)
      field = load<T>(args.lane_slots[k] + position);
    else if (common)
      field = T(args.records[first + k]);
    else
      field = gather<T>(args.records + k, offset);
  }
  FACETA_INLINE void choice_at(int& field) { field = choices[choice_index++]; }
  FACETA_INLINE void file_at(const float*& field) { field = args.tables; }
  FACETA_INLINE void table_at(Table<T>& field) {
    int k = slot++;
    field.base = args.tables;
    // Offsets are whole numbers below 2^24, exact in a float slot.
    field.offset = common ? IntOf<T>(static_cast<int32_t>(args.records[first + k]))
                          : to_int(gather<T>(args.records + k, offset));
  }
};

/// Writes the fields of the double reference into a record.
template <class M> struct RecordWriter : FieldVisitor<RecordWriter<M>, M, double> {
  std::vector<float>& record;
  std::vector<int32_t>& choices;
  RecordWriter(M& m, std::vector<float>& r, std::vector<int32_t>& c)
      : FieldVisitor<RecordWriter, M, double>(m), record(r), choices(c) {}
  void number_at(double& field) { record.push_back(static_cast<float>(field)); }
  void choice_at(int& field) { choices.push_back(field); }
  void table_at(Table<double>& field) { record.push_back(static_cast<float>(field.offset)); }
};

/// Collects pointers to the number fields, in slot order (null for tables).
template <class M, class T> struct FieldPointers : FieldVisitor<FieldPointers<M, T>, M, T> {
  std::vector<T*> fields;
  explicit FieldPointers(M& m) : FieldVisitor<FieldPointers, M, T>(m) {}
  void number_at(T& field) { fields.push_back(&field); }
  void choice_at(int&) {}
  void table_at(Table<T>&) { fields.push_back(nullptr); }
};

/// Loads a model and runs its prepare(). choices[k] is choice or flag number k.
template <template <class> class Model, class T, class Choices>
FACETA_INLINE Model<T> load_model(const MaterialArgs& args, const Choices& choices, int position) {
  Model<T> m;
  RecordLoader<Model<T>, T, Choices> loader(m, args, choices, position);
  Model<T>::describe(loader);
  if constexpr (requires { m.prepare(); })
    m.prepare();
  return m;
}

} // namespace faceta
