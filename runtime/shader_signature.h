#pragma once

// Which C++ callables are shaders: the context of the stage, then payload and attributes as parameters as in HLSL
// (STG-11). A functor's operator() is const, because many lanes run one functor at a time.

#include <rayloom/runtime/stage_context.h>

#include <tuple>
#include <type_traits>

namespace rayloom {

namespace detail {

template <class R, class... P>
struct Call {
  using Result = R;
  using Parameters = std::tuple<P...>;
};

template <class F>
struct CallOf {};
template <class R, class... P>
struct CallOf<R (*)(P...)> : Call<R, P...> {};
template <class R, class... P>
struct CallOf<R (*)(P...) noexcept> : Call<R, P...> {};
template <class R, class C, class... P>
struct CallOf<R (C::*)(P...) const> : Call<R, P...> {};
template <class R, class C, class... P>
struct CallOf<R (C::*)(P...) const noexcept> : Call<R, P...> {};
template <class F>
requires requires { &F::operator(); }
struct CallOf<F> : CallOf<decltype(&F::operator())> {};

template <class F, class Result>
concept Returns = std::same_as<typename CallOf<F>::Result, Result>;

/// The I-th parameter type of F; void when there is none.
template <class F, size_t I>
struct ParameterAt {
  using type = void;
};
template <class F, size_t I>
requires(I < std::tuple_size_v<typename CallOf<F>::Parameters>) struct ParameterAt<F, I> {
  using type = std::tuple_element_t<I, typename CallOf<F>::Parameters>;
};
template <class F, size_t I>
using Parameter = typename ParameterAt<F, I>::type;
template <class F, size_t N>
concept Takes = std::tuple_size_v<typename CallOf<F>::Parameters>
== N;

/// `Struct&`, changed by the shader; or `const Struct&`, read only.
template <class P>
concept InOut = std::is_lvalue_reference_v<P> && !std::is_const_v<std::remove_reference_t<P>> &&
                PlainStruct<std::remove_reference_t<P>>;
template <class P>
concept In =
    std::is_lvalue_reference_v<P> && std::is_const_v<std::remove_reference_t<P>> && PlainStruct<std::remove_cvref_t<P>>;

template <class F, class Context, size_t N>
concept ShaderOf = std::is_copy_constructible_v<F> && Takes<F, N> && std::same_as<Parameter<F, 0>, Context&>;

template <class F, size_t I>
using StructAt = std::remove_cvref_t<Parameter<F, I>>;

}  // namespace detail

template <class F>
concept RayGenerationShader = detail::ShaderOf<F, RayGenContext, 1> && detail::Returns<F, void>;
template <class F>
concept IntersectionShader = detail::ShaderOf<F, IntersectionContext, 1> &&
    (detail::Returns<F, IntersectionVerdict> || detail::Returns<F, ReportHitResult>);
template <class F>
concept AnyHitShader = detail::ShaderOf<F, AnyHitContext, 3> && detail::Returns<F, AnyHitVerdict> &&
    detail::InOut<detail::Parameter<F, 1>> && detail::In<detail::Parameter<F, 2>>;
template <class F>
concept ClosestHitShader = detail::ShaderOf<F, ClosestHitContext, 3> && detail::Returns<F, void> &&
    detail::InOut<detail::Parameter<F, 1>> && detail::In<detail::Parameter<F, 2>>;
template <class F>
concept MissShader =
    detail::ShaderOf<F, MissContext, 2> && detail::Returns<F, void> && detail::InOut<detail::Parameter<F, 1>>;
template <class F>
concept CallableShader =
    detail::ShaderOf<F, CallableContext, 2> && detail::Returns<F, void> && detail::InOut<detail::Parameter<F, 1>>;

}  // namespace rayloom
