#pragma once

// A library of shaders: named functors, copied in (SO-04, SO-09). Libraries enter a state object as subobjects.

#include <rayloom/runtime/shader_signature.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace rayloom {

/// What a shader declares beside its code.
struct ShaderOptions {
  ShaderCost cost = {};       ///< for the hardware model
  uint32_t stack_bytes = 0;   ///< 0: estimated as 128 + payload or parameters + attributes (docs/dxr-differences.md)
  TypeInfo local_root = {};   ///< root_type<L>(): the shader reads ctx.LocalRoot<L>()
  TypeInfo global_root = {};  ///< root_type<G>(): the shader reads ctx.GlobalRoot<G>()
};

template <PlainStruct T>
TypeInfo root_type() {
  return type_info_of<T>();
}

namespace detail {

/// Runs a functor. `data` is the payload or the parameters. Only any-hit shaders answer other than `accept`.
using ShaderEntry = HitDecision (*)(const void* functor, Invocation&, void* data, const void* attributes);

struct ShaderDefinition {
  std::string name;
  ShaderStage stage = ShaderStage::ray_generation;
  ShaderOptions options;
  TypeInfo payload;     ///< or parameters of a callable
  TypeInfo attributes;  ///< AH, CH
  std::shared_ptr<const void> functor;
  ShaderEntry entry = nullptr;

  /// In the bytes of SID-08..12.
  uint64_t stack_bytes() const {
    return options.stack_bytes ? options.stack_bytes : 128u + payload.bytes + attributes.bytes;
  }
};

template <class F>
HitDecision run_ray_generation(const void* functor, Invocation& invocation, void*, const void*) {
  RayGenContext context(invocation);
  (*static_cast<const F*>(functor))(context);
  return HitDecision::accept;
}
template <class F>
HitDecision run_intersection(const void* functor, Invocation& invocation, void*, const void*) {
  IntersectionContext context(invocation);
  static_cast<void>((*static_cast<const F*>(functor))(context));
  return HitDecision::accept;
}
template <class F>
HitDecision run_any_hit(const void* functor, Invocation& invocation, void* payload, const void* attributes) {
  AnyHitContext context(invocation);
  return VerdictAccess::decision((*static_cast<const F*>(functor))(context, *static_cast<StructAt<F, 1>*>(payload),
                                                                   *static_cast<const StructAt<F, 2>*>(attributes)));
}
template <class F>
HitDecision run_closest_hit(const void* functor, Invocation& invocation, void* payload, const void* attributes) {
  ClosestHitContext context(invocation);
  (*static_cast<const F*>(functor))(context, *static_cast<StructAt<F, 1>*>(payload),
                                    *static_cast<const StructAt<F, 2>*>(attributes));
  return HitDecision::accept;
}
template <class F, class Context>
HitDecision run_with_data(const void* functor, Invocation& invocation, void* data, const void*) {
  Context context(invocation);
  (*static_cast<const F*>(functor))(context, *static_cast<StructAt<F, 1>*>(data));
  return HitDecision::accept;
}

}  // namespace detail

class ShaderLibrary {
 public:
  template <class F>
  ShaderLibrary& RayGeneration(std::string name, F shader, ShaderOptions options = {}) {
    static_assert(RayGenerationShader<F>, "rayloom: a ray generation shader is void(RayGenContext&) [STG-11]");
    if constexpr (RayGenerationShader<F>)
      add(ShaderStage::ray_generation, name, std::move(shader), options, detail::run_ray_generation<F>);
    return *this;
  }
  template <class F>
  ShaderLibrary& Intersection(std::string name, F shader, ShaderOptions options = {}) {
    static_assert(IntersectionShader<F>,
                  "rayloom: an intersection shader is IntersectionVerdict(IntersectionContext&) [STG-11]");
    if constexpr (IntersectionShader<F>)
      add(ShaderStage::intersection, name, std::move(shader), options, detail::run_intersection<F>);
    return *this;
  }
  template <class F>
  ShaderLibrary& AnyHit(std::string name, F shader, ShaderOptions options = {}) {
    static_assert(AnyHitShader<F>,
                  "rayloom: an any-hit shader is AnyHitVerdict(AnyHitContext&, Payload&, const Attributes&) [STG-11]");
    if constexpr (AnyHitShader<F>)
      add(ShaderStage::any_hit, name, std::move(shader), options, detail::run_any_hit<F>,
          type_info_of<detail::StructAt<F, 1>>(), type_info_of<detail::StructAt<F, 2>>());
    return *this;
  }
  template <class F>
  ShaderLibrary& ClosestHit(std::string name, F shader, ShaderOptions options = {}) {
    static_assert(ClosestHitShader<F>,
                  "rayloom: a closest-hit shader is void(ClosestHitContext&, Payload&, const Attributes&) [STG-11]");
    if constexpr (ClosestHitShader<F>)
      add(ShaderStage::closest_hit, name, std::move(shader), options, detail::run_closest_hit<F>,
          type_info_of<detail::StructAt<F, 1>>(), type_info_of<detail::StructAt<F, 2>>());
    return *this;
  }
  template <class F>
  ShaderLibrary& Miss(std::string name, F shader, ShaderOptions options = {}) {
    static_assert(MissShader<F>, "rayloom: a miss shader is void(MissContext&, Payload&) [STG-11]");
    if constexpr (MissShader<F>)
      add(ShaderStage::miss, name, std::move(shader), options, detail::run_with_data<F, MissContext>,
          type_info_of<detail::StructAt<F, 1>>());
    return *this;
  }
  template <class F>
  ShaderLibrary& Callable(std::string name, F shader, ShaderOptions options = {}) {
    static_assert(CallableShader<F>, "rayloom: a callable shader is void(CallableContext&, Parameters&) [STG-11]");
    if constexpr (CallableShader<F>)
      add(ShaderStage::callable, name, std::move(shader), options, detail::run_with_data<F, CallableContext>,
          type_info_of<detail::StructAt<F, 1>>());
    return *this;
  }

  const std::vector<detail::ShaderDefinition>& shaders() const { return shaders_; }

 private:
  template <class F>
  void add(ShaderStage stage, std::string& name, F shader, const ShaderOptions& options, detail::ShaderEntry entry,
           TypeInfo payload = {}, TypeInfo attributes = {}) {
    shaders_.push_back(
        {std::move(name), stage, options, payload, attributes, std::make_shared<const F>(std::move(shader)), entry});
  }

  std::vector<detail::ShaderDefinition> shaders_;
};

}  // namespace rayloom
