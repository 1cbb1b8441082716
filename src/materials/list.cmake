# The registration list: one line a model, header:Struct. Everything else about it comes by itself.
faceta_add_material_modules(builtin
  MATERIALS
    materials/diffuse.h:Diffuse
  EXTRA ${FACETA_RENDER_KERNELS}
  LIBS embree)
