# The registration list: one line a model, header:Struct. Everything else about it comes by itself.
faceta_add_material_modules(builtin
  MATERIALS
    materials/diffuse.h:Diffuse
    materials/conductor.h:Conductor
    materials/roughconductor.h:RoughConductor
    materials/dielectric.h:Dielectric
    materials/thindielectric.h:ThinDielectric
    materials/roughdielectric.h:RoughDielectric
    materials/orennayar.h:OrenNayar
    materials/phong.h:Phong
    materials/blinnphong.h:BlinnPhong
    materials/ward.h:Ward
    materials/plastic.h:Plastic
    materials/roughplastic.h:RoughPlastic
    materials/measured.h:Measured
    materials/measuredwindow.h:MeasuredWindow
    materials/hazygloss.h:HazyGloss
  EXTRA ${FACETA_RENDER_KERNELS}
  LIBS embree)
