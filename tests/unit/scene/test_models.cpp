#include "test_models.h"

#include "bsdf/model.h"

using namespace faceta;

namespace test {

template <class T> struct Glossy {
  Color<T> tint{T(0.5)};
  T alpha_u = T(0.1), alpha_v = T(0.1), size = T(1), mean_tint = T(0);
  int kind = 0;
  Table<T> table;

  template <class D> static void describe(D& d) {
    d.model("glossy", "")
        .reflectance("tint", &Glossy::tint, "")
        .table(&Glossy::table)
        .roughness(&Glossy::alpha_u, &Glossy::alpha_v, "")
        .scalar("size", &Glossy::size, {0, 10}, {0, 1}, "", "")
        .choice("kind", &Glossy::kind, {"one", "two"}, "")
        .derived(&Glossy::mean_tint)
        .traits({.lobes = kReflection});
  }
  void prepare_once(PrepareOnce& once) {
    mean_tint = (tint[0] + tint[1] + tint[2]) / T(3);
    table = once.add_table({double(size), double(size) + 1});
  }
};

template <class T> struct Glass {
  T eta = T(1.5);
  template <class D> static void describe(D& d) {
    d.model("glass", "")
        .number("eta", &Glass::eta, {1, 3}, {1, 3}, "", "")
        .traits({.lobes = kReflection | kTransmission, .delta = true});
  }
};

template <class T> struct Mirror {
  Color<T> tint{T(1)};
  template <class D> static void describe(D& d) {
    d.model("mirror", "")
        .reflectance("tint", &Mirror::tint, "")
        .traits({.lobes = kReflection, .delta = true});
  }
};

namespace {

// Scenes only pass the pointer on.
const MaterialKernel kKernel{"silent", nullptr, nullptr, nullptr};

template <template <class> class M> Record make_record(const std::vector<double>& slots,
                                                       const std::vector<int32_t>& choices,
                                                       const std::vector<std::string>&) {
  M<double> m;
  FieldPointers<M<double>, double> pointers(m);
  M<double>::describe(pointers);
  for (size_t i = 0; i < slots.size(); ++i)
    if (pointers.fields[i])
      *pointers.fields[i] = slots[i];
  Record record;
  PrepareOnce once{record.tables};
  if constexpr (requires { m.prepare_once(once); })
    m.prepare_once(once);
  RecordWriter<M<double>> writer(m, record.slots, record.choices);
  M<double>::describe(writer);
  record.choices = choices;
  return record;
}

template <template <class> class M> Model make() {
  Model model{};
  DescriptorBuilder<M<double>> builder;
  M<double>::describe(builder);
  model.descriptor = builder.descriptor;
  model.make_record = make_record<M>;
  model.kernels = {&kKernel, &kKernel, nullptr};
  return model;
}

} // namespace

const Model& glossy() {
  static const Model model = make<Glossy>();
  return model;
}
const Model& glass() {
  static const Model model = make<Glass>();
  return model;
}
const Model& mirror() {
  static const Model model = make<Mirror>();
  return model;
}

Node leaf(const Model& model) {
  auto node = std::make_shared<MaterialNode>();
  node->parameters = std::make_shared<Parameters>(model);
  return node;
}

Node tree(MaterialNode::Kind kind, std::vector<Node> children, double weight) {
  auto node = std::make_shared<MaterialNode>();
  node->kind = kind;
  node->children = std::move(children);
  node->weight.value = {weight, weight, weight};
  return node;
}

ShapeDesc grey_shape(Scene& scene) {
  ShapeDesc shape;
  shape.material = scene.add_material(leaf(glossy()));
  shape.name = "test shape";
  return shape;
}

std::shared_ptr<AreaEmitter> emitter(double radiance, double sampling_weight) {
  auto e = std::make_shared<AreaEmitter>();
  e->radiance.value = {radiance, radiance, radiance};
  e->sampling_weight = sampling_weight;
  return e;
}

} // namespace test
