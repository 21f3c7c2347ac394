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
template <class Enum>
constexpr int words = 0;  // the specializations are arrays
template <>
constexpr EnumName<Backend> words<Backend>[] = {{Backend::automatic, "auto"},
                                                {Backend::cuda, "cuda"},
                                                {Backend::cpu, "cpu"},
                                                {Backend::reference, "reference"}};
template <>
constexpr EnumName<PixelType> words<PixelType>[] = {
    {PixelType::uint8, "uint8"},    {PixelType::int8, "int8"},     {PixelType::uint16, "uint16"},
    {PixelType::int16, "int16"},    {PixelType::uint32, "uint32"}, {PixelType::int32, "int32"},
    {PixelType::uint64, "uint64"},  {PixelType::int64, "int64"},   {PixelType::float32, "float32"},
    {PixelType::float64, "float64"}};
template <>
constexpr EnumName<Filter> words<Filter>[] = {
    {Filter::linear, "linear"},   {Filter::nearest, "nearest"}, {Filter::cubic, "cubic"},
    {Filter::bspline, "bspline"}, {Filter::lanczos, "lanczos"}, {Filter::labels, "labels"}};
template <>
constexpr EnumName<LabelRule> words<LabelRule>[] = {{LabelRule::linear, "linear"},
                                                    {LabelRule::volume, "volume"},
                                                    {LabelRule::gaussian, "gaussian"}};
template <>
constexpr EnumName<Overshoot> words<Overshoot>[] = {{Overshoot::keep, "keep"},
                                                    {Overshoot::clamp, "clamp"}};
template <>
constexpr EnumName<Quantity> words<Quantity>[] = {
    {Quantity::components, "components"},      {Quantity::vector, "rotate"},
    {Quantity::covariant_vector, "covariant"}, {Quantity::contravariant_vector, "contravariant"},
    {Quantity::tensor, "finite-strain"},       {Quantity::principal_tensor, "principal"}};
template <>
constexpr EnumName<Intensity> words<Intensity>[] = {{Intensity::value, "value"},
                                                    {Intensity::density, "density"},
                                                    {Intensity::conservative, "conservative"}};
template <>
constexpr EnumName<Outside> words<Outside>[] = {{Outside::background, "background"},
                                                {Outside::identity, "identity"},
                                                {Outside::nearest, "nearest"},
                                                {Outside::falloff, "falloff"}};
template <>
constexpr EnumName<Deformation> words<Deformation>[] = {
    {Deformation::twist, "twist"},   {Deformation::bend, "bend"},
    {Deformation::swim, "swim"},     {Deformation::random, "random"},
    {Deformation::rotate, "rotate"}, {Deformation::translate, "translate"}};
template <>
constexpr EnumName<FrictionLaw> words<FrictionLaw>[] = {{FrictionLaw::cone, "cone"},
                                                        {FrictionLaw::pyramid, "pyramid"}};
template <>
constexpr EnumName<AdhesionRule> words<AdhesionRule>[] = {
    {AdhesionRule::parallel, "parallel"}, {AdhesionRule::restrictive, "restrictive"}};
template <>
constexpr EnumName<ContactMethod> words<ContactMethod>[] = {{ContactMethod::automatic, "auto"},
                                                            {ContactMethod::gauss_seidel, "gs"},
                                                            {ContactMethod::nonlinear_cg, "nncg"},
                                                            {ContactMethod::anderson, "anderson"},
                                                            {ContactMethod::newton, "newton"}};
template <>
constexpr EnumName<ContactCoupling> words<ContactCoupling>[] = {
    {ContactCoupling::automatic, "auto"},
    {ContactCoupling::condensed, "condensed"},
    {ContactCoupling::iterated, "iterated"}};
template <>
constexpr EnumName<ContactMeasure> words<ContactMeasure>[] = {{ContactMeasure::eta, "eta"},
                                                              {ContactMeasure::fclib, "fclib"}};
template <>
constexpr EnumName<ContactPrecision> words<ContactPrecision>[] = {
    {ContactPrecision::float64, "double"}, {ContactPrecision::float32, "single"}};
template <>
constexpr EnumName<ContactStatus> words<ContactStatus>[] = {
    {ContactStatus::converged, "converged"},
    {ContactStatus::not_converged, "not converged"},
    {ContactStatus::infeasible, "infeasible"},
    {ContactStatus::unbounded, "unbounded"}};
template <>
constexpr EnumName<AdhesionIntegrator> words<AdhesionIntegrator>[] = {
    {AdhesionIntegrator::exact, "exact"}, {AdhesionIntegrator::explicit_euler, "explicit-euler"}};
template <>
constexpr EnumName<BodyKind> words<BodyKind>[] = {{BodyKind::fem, "fem"},
                                                  {BodyKind::rigid, "rigid"},
                                                  {BodyKind::cloth, "cloth"},
                                                  {BodyKind::scripted, "scripted"}};
template <>
constexpr EnumName<TransferLookup> words<TransferLookup>[] = {{TransferLookup::linear, "linear"},
                                                              {TransferLookup::label, "label"}};
template <>
constexpr EnumName<MaterialMean> words<MaterialMean>[] = {{MaterialMean::arithmetic, "arithmetic"},
                                                          {MaterialMean::harmonic, "harmonic"}};
template <>
constexpr EnumName<MassKind> words<MassKind>[] = {{MassKind::consistent, "consistent"},
                                                  {MassKind::lumped, "lumped"}};
}  // namespace

template <class Enum>
std::span<const EnumName<Enum>> names_of() {
  return words<Enum>;
}

template TETWARP_EXPORT std::span<const EnumName<Backend>> names_of();
template TETWARP_EXPORT std::span<const EnumName<PixelType>> names_of();
template TETWARP_EXPORT std::span<const EnumName<Filter>> names_of();
template TETWARP_EXPORT std::span<const EnumName<LabelRule>> names_of();
template TETWARP_EXPORT std::span<const EnumName<Overshoot>> names_of();
template TETWARP_EXPORT std::span<const EnumName<Quantity>> names_of();
template TETWARP_EXPORT std::span<const EnumName<Intensity>> names_of();
template TETWARP_EXPORT std::span<const EnumName<Outside>> names_of();
template TETWARP_EXPORT std::span<const EnumName<Deformation>> names_of();
template TETWARP_EXPORT std::span<const EnumName<FrictionLaw>> names_of();
template TETWARP_EXPORT std::span<const EnumName<AdhesionRule>> names_of();
template TETWARP_EXPORT std::span<const EnumName<ContactMethod>> names_of();
template TETWARP_EXPORT std::span<const EnumName<ContactCoupling>> names_of();
template TETWARP_EXPORT std::span<const EnumName<ContactMeasure>> names_of();
template TETWARP_EXPORT std::span<const EnumName<ContactPrecision>> names_of();
template TETWARP_EXPORT std::span<const EnumName<ContactStatus>> names_of();
template TETWARP_EXPORT std::span<const EnumName<AdhesionIntegrator>> names_of();
template TETWARP_EXPORT std::span<const EnumName<BodyKind>> names_of();
template TETWARP_EXPORT std::span<const EnumName<TransferLookup>> names_of();
template TETWARP_EXPORT std::span<const EnumName<MaterialMean>> names_of();
template TETWARP_EXPORT std::span<const EnumName<MassKind>> names_of();

}  // namespace tetwarp
