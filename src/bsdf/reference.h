#pragma once

/// Builds the registry entry of a model: its descriptor and its double and Jet functions. Included
/// once per model, by the translation units that cmake/Modules.cmake generates.

#include "base/jet.h"
#include "bsdf/model.h"
#include "bsdf/registry.h"

namespace faceta {

template <template <class> class M> struct ReferenceOf {
  using J = Jet<double, 8>;

  static Model make() {
    DescriptorBuilder<M<double>> builder;
    M<double>::describe(builder);
    Model model;
    model.descriptor = std::move(builder.descriptor);
    model.make_record = make_record;
    model.eval = eval;
    model.sample = sample;
    model.eval_at = eval_at;
    model.eval_jet = eval_jet;
    model.eval_rows = eval_rows;
    model.eval_wide = eval_wide;
    model.sample_wide = sample_wide;
    return model;
  }

private:
  static Record make_record(const std::vector<double>& slots, const std::vector<int32_t>& choices,
                            const std::vector<std::string>& textured) {
    M<double> m;
    FieldPointers<M<double>, double> pointers(m);
    M<double>::describe(pointers);
    for (size_t i = 0; i < slots.size() && i < pointers.fields.size(); ++i)
      if (pointers.fields[i])
        *pointers.fields[i] = slots[i];
    ChoiceSetter setter(m, choices);
    M<double>::describe(setter);
    if constexpr (requires { M<double>::validate(m); })
      if (const char* problem = M<double>::validate(m))
        throw Error(problem);
    Record record;
    if constexpr (requires(PrepareOnce& p) { m.prepare_once(p); }) {
      PrepareOnce context{record.tables, textured};
      m.prepare_once(context);
    }
    RecordWriter<M<double>> writer(m, record.slots, record.choices);
    M<double>::describe(writer);
    return record;
  }
  struct ChoiceSetter : FieldVisitor<ChoiceSetter, M<double>, double> {
    const std::vector<int32_t>& values;
    size_t next = 0;
    ChoiceSetter(M<double>& m, const std::vector<int32_t>& v)
        : FieldVisitor<ChoiceSetter, M<double>, double>(m), values(v) {}
    void number_at(double&) {}
    void choice_at(int& field) {
      if (next < values.size())
        field = values[next];
      ++next;
    }
    void table_at(Table<double>&) {}
  };

  using W = Jet<double, 0>;
  /// Loads a record whose colours have three channels into more: the three again and again.
  struct WideLoader : FieldVisitor<WideLoader, M<W>, W> {
    const Record& record;
    size_t next_slot = 0, next_choice = 0;
    WideLoader(M<W>& m, const Record& r) : FieldVisitor<WideLoader, M<W>, W>(m), record(r) {}
    void number_at(W& field) { field = W(double(record.slots[next_slot++])); }
    WideLoader& color_field(Color<W> M<W>::* f) {
      for (int i = 0; i < Color<W>::size(); ++i)
        (this->m.*f)[i] = W(double(record.slots[next_slot + size_t(i % 3)]));
      next_slot += 3;
      return *this;
    }
    void choice_at(int& field) { field = record.choices[next_choice++]; }
    void file_at(const float*& field) { field = record.args().tables; }
    void table_at(Table<W>& field) {
      field.base = record.tables.data();
      field.offset = static_cast<int32_t>(record.slots[next_slot++]);
    }
  };

  template <class T> static Vec3<T> convert(const Vec3<double>& v) {
    return {T(v.x), T(v.y), T(v.z)};
  }
  template <class T> static Context<T> context(const ReferenceQuery& q) {
    Context<T> c;
    c.mode = q.mode;
    c.uv = {T(q.uv.x), T(q.uv.y)};
    return c;
  }
  static Eval<double> eval(const Record& record, const ReferenceQuery& q) {
    return load_model<M, double>(record.args(), record.args().choices, 0)
        .eval(q.wo, q.wi, context<double>(q));
  }
  static Sample<double> sample(const Record& record, const Vec3<double>& wo,
                               const Random<double>& random, TransportMode mode, Vec2<double> uv) {
    Context<double> c{mode, uv};
    return load_model<M, double>(record.args(), record.args().choices, 0).sample(wo, random, c);
  }
  template <class T> static M<T> load_with(const Record& record, const std::vector<double>& slots,
                                           const std::vector<int>& active) {
    M<T> m;
    MaterialArgs args = record.args();
    RecordLoader<M<T>, T, const int32_t*> loader(m, args, args.choices, 0);
    M<T>::describe(loader);
    FieldPointers<M<T>, T> pointers(m);
    M<T>::describe(pointers);
    for (size_t i = 0; i < slots.size() && i < pointers.fields.size(); ++i)
      if (pointers.fields[i])
        *pointers.fields[i] = T(slots[i]);
    if constexpr (!std::is_same_v<T, double>)
      for (size_t k = 0; k < active.size(); ++k)
        pointers.fields[active[k]]->v[static_cast<int>(k)] = 1.0;
    if constexpr (requires { m.prepare(); })
      m.prepare();
    return m;
  }
  static Eval<double> eval_at(const Record& record, const std::vector<double>& slots,
                              const ReferenceQuery& q) {
    return load_with<double>(record, slots, {}).eval(q.wo, q.wi, context<double>(q));
  }
  static ReferenceJet eval_jet(const Record& record, const std::vector<double>& slots,
                               const std::vector<int>& active, const ReferenceQuery& q) {
    Eval<J> e =
        load_with<J>(record, slots, active).eval(convert<J>(q.wo), convert<J>(q.wi), context<J>(q));
    ReferenceJet r{};
    for (int i = 0; i < 4; ++i) {
      const J& j = i < 3 ? e.value[i] : e.pdf;
      r.value[i] = j.a;
      for (int k = 0; k < 8; ++k)
        r.derivative[i][k] = j.v[k];
    }
    return r;
  }
  /// Derivatives of eval_rows in one pass: the most that pay in registers and cache.
  static constexpr size_t kPass = 14;
  /// The value of eval(), without the density where the model offers value(wo, wi).
  template <class T> static Color<T> value_of(const M<T>& m, const DirectionPair& p) {
    Vec3<T> wo = convert<T>(p.wo), wi = convert<T>(p.wi);
    if constexpr (requires { m.value(wo, wi); })
      return m.value(wo, wi);
    else
      return m.eval(wo, wi, {}).value;
  }
  static void eval_rows(const Record& record, const std::vector<double>& slots,
                        const std::vector<int>& active, std::span<const DirectionPair> rows,
                        double* values, double* derivatives) {
    using R = Jet<double, kPass>;
    size_t n = derivatives ? active.size() : 0;
    if (n == 0) {
      M<double> m = load_with<double>(record, slots, {});
      for (size_t i = 0; i < rows.size(); ++i) {
        Color<double> value = value_of<double>(m, rows[i]);
        for (int c = 0; c < 3; ++c)
          values[3 * i + size_t(c)] = value[c];
      }
    }
    for (size_t first = 0; first < n; first += kPass) {
      size_t count = std::min(kPass, n - first);
      std::vector<int> pass(active.begin() + long(first), active.begin() + long(first + count));
      M<R> m = load_with<R>(record, slots, pass);
      for (size_t i = 0; i < rows.size(); ++i) {
        Color<R> value = value_of<R>(m, rows[i]);
        for (int c = 0; c < 3; ++c) {
          size_t at = 3 * i + size_t(c);
          values[at] = value[c].a;
          for (size_t k = 0; k < count; ++k)
            derivatives[at * n + first + k] = value[c].v[int(k)];
        }
      }
    }
  }
  static M<W> load_wide(const Record& record) {
    M<W> m;
    WideLoader loader(m, record);
    M<W>::describe(loader);
    if constexpr (requires { m.prepare(); })
      m.prepare();
    return m;
  }
  static ReferenceWide to_wide(const Color<W>& color, const W& pdf) {
    ReferenceWide r{};
    for (int i = 0; i < Color<W>::size(); ++i)
      r.color[i] = color[i].a;
    r.pdf = pdf.a;
    return r;
  }
  static ReferenceWide eval_wide(const Record& record, const ReferenceQuery& q) {
    Eval<W> e = load_wide(record).eval(convert<W>(q.wo), convert<W>(q.wi), context<W>(q));
    return to_wide(e.value, e.pdf);
  }
  static ReferenceWide sample_wide(const Record& record, const Vec3<double>& wo,
                                   const Random<double>& r) {
    Random<W> random{{W(r.u.x), W(r.u.y)}, W(r.uc)};
    Sample<W> s = load_wide(record).sample(convert<W>(wo), random, {});
    return s.valid ? to_wide(s.weight, s.pdf) : ReferenceWide{};
  }
};

} // namespace faceta

/// Defines `faceta::Model faceta_model_<symbol>()`.
#define FACETA_MATERIAL_REFERENCE(symbol, Type)                                                    \
  faceta::Model faceta_model_##symbol() {                                                          \
    return faceta::ReferenceOf<Type>::make();                                                      \
  }
