/// @file names.cpp
/// The words of the enums of the library.
#include <tetwarp/backend.hpp>
#include <tetwarp/contact.hpp>
#include <tetwarp/make.hpp>
#include <tetwarp/names.hpp>
#include <tetwarp/scene.hpp>
#include <tetwarp/warp.hpp>

namespace tetwarp {
namespace {
constexpr EnumName<Backend> backend_names[] = {{Backend::automatic, "auto"},
                                               {Backend::cuda, "cuda"},
                                               {Backend::cpu, "cpu"},
                                               {Backend::reference, "reference"}};
constexpr EnumName<PixelType> pixel_type_names[] = {
    {PixelType::uint8, "uint8"},    {PixelType::int8, "int8"},     {PixelType::uint16, "uint16"},
    {PixelType::int16, "int16"},    {PixelType::uint32, "uint32"}, {PixelType::int32, "int32"},
    {PixelType::uint64, "uint64"},  {PixelType::int64, "int64"},   {PixelType::float32, "float32"},
    {PixelType::float64, "float64"}};
constexpr EnumName<Filter> filter_names[] = {
    {Filter::linear, "linear"},   {Filter::nearest, "nearest"}, {Filter::cubic, "cubic"},
    {Filter::bspline, "bspline"}, {Filter::lanczos, "lanczos"}, {Filter::labels, "labels"}};
constexpr EnumName<Overshoot> overshoot_names[] = {{Overshoot::keep, "keep"},
                                                   {Overshoot::clamp, "clamp"}};
constexpr EnumName<Quantity> quantity_names[] = {
    {Quantity::components, "components"},      {Quantity::vector, "rotate"},
    {Quantity::covariant_vector, "covariant"}, {Quantity::contravariant_vector, "contravariant"},
    {Quantity::tensor, "finite-strain"},       {Quantity::principal_tensor, "principal"}};
constexpr EnumName<Intensity> intensity_names[] = {{Intensity::value, "value"},
                                                   {Intensity::density, "density"},
                                                   {Intensity::conservative, "conservative"}};
constexpr EnumName<Outside> outside_names[] = {{Outside::background, "background"},
                                               {Outside::identity, "identity"}};
constexpr EnumName<Deformation> deformation_names[] = {
    {Deformation::twist, "twist"},   {Deformation::bend, "bend"},
    {Deformation::swim, "swim"},     {Deformation::random, "random"},
    {Deformation::rotate, "rotate"}, {Deformation::translate, "translate"}};
constexpr EnumName<FrictionLaw> friction_law_names[] = {{FrictionLaw::cone, "cone"},
                                                        {FrictionLaw::pyramid, "pyramid"}};
constexpr EnumName<AdhesionRule> adhesion_rule_names[] = {
    {AdhesionRule::parallel, "parallel"}, {AdhesionRule::restrictive, "restrictive"}};
constexpr EnumName<ContactMethod> contact_method_names[] = {
    {ContactMethod::automatic, "auto"},
    {ContactMethod::gauss_seidel, "gs"},
    {ContactMethod::nonlinear_cg, "nncg"},
    {ContactMethod::anderson, "anderson"},
    {ContactMethod::mass_splitting, "mass-splitting"},
    {ContactMethod::newton, "newton"}};
constexpr EnumName<ContactCoupling> contact_coupling_names[] = {
    {ContactCoupling::automatic, "auto"},
    {ContactCoupling::condensed, "condensed"},
    {ContactCoupling::iterated, "iterated"}};
constexpr EnumName<ContactMeasure> contact_measure_names[] = {{ContactMeasure::eta, "eta"},
                                                              {ContactMeasure::fclib, "fclib"}};
constexpr EnumName<ContactPrecision> contact_precision_names[] = {
    {ContactPrecision::float64, "double"}, {ContactPrecision::float32, "single"}};
constexpr EnumName<ContactStatus> contact_status_names[] = {
    {ContactStatus::converged, "converged"},
    {ContactStatus::not_converged, "not converged"},
    {ContactStatus::infeasible, "infeasible"},
    {ContactStatus::unbounded, "unbounded"}};
constexpr EnumName<AdhesionIntegrator> adhesion_integrator_names[] = {
    {AdhesionIntegrator::exact, "exact"}, {AdhesionIntegrator::explicit_euler, "explicit-euler"}};
constexpr EnumName<BodyKind> body_kind_names[] = {{BodyKind::fem, "fem"},
                                                  {BodyKind::rigid, "rigid"},
                                                  {BodyKind::cloth, "cloth"},
                                                  {BodyKind::scripted, "scripted"}};
constexpr EnumName<TransferLookup> transfer_lookup_names[] = {{TransferLookup::linear, "linear"},
                                                              {TransferLookup::label, "label"}};
constexpr EnumName<MaterialMean> material_mean_names[] = {{MaterialMean::arithmetic, "arithmetic"},
                                                          {MaterialMean::harmonic, "harmonic"}};
constexpr EnumName<MassKind> mass_kind_names[] = {{MassKind::consistent, "consistent"},
                                                  {MassKind::lumped, "lumped"}};
}  // namespace

template <>
TETWARP_EXPORT std::span<const EnumName<Backend>> names_of() {
  return backend_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<PixelType>> names_of() {
  return pixel_type_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<Filter>> names_of() {
  return filter_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<Overshoot>> names_of() {
  return overshoot_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<Quantity>> names_of() {
  return quantity_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<Intensity>> names_of() {
  return intensity_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<Outside>> names_of() {
  return outside_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<Deformation>> names_of() {
  return deformation_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<FrictionLaw>> names_of() {
  return friction_law_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<AdhesionRule>> names_of() {
  return adhesion_rule_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<ContactMethod>> names_of() {
  return contact_method_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<ContactCoupling>> names_of() {
  return contact_coupling_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<ContactMeasure>> names_of() {
  return contact_measure_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<ContactPrecision>> names_of() {
  return contact_precision_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<ContactStatus>> names_of() {
  return contact_status_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<AdhesionIntegrator>> names_of() {
  return adhesion_integrator_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<BodyKind>> names_of() {
  return body_kind_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<TransferLookup>> names_of() {
  return transfer_lookup_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<MaterialMean>> names_of() {
  return material_mean_names;
}
template <>
TETWARP_EXPORT std::span<const EnumName<MassKind>> names_of() {
  return mass_kind_names;
}

}  // namespace tetwarp
