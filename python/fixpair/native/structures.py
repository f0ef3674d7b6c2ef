"""The structures of fixpair.h, and the types of its hooks. f32 and f64 twins have one type: data is passed as an address."""

import ctypes

c_double, c_int32, c_size_t, c_uint32, c_uint64, c_void_p = (
    ctypes.c_double, ctypes.c_int32, ctypes.c_size_t, ctypes.c_uint32, ctypes.c_uint64, ctypes.c_void_p)


class Structure(ctypes.Structure):
    """A structure that shows its members, and refuses to be given one that it does not have."""

    def __setattr__(self, name, value):
        if not (name.startswith("_") or hasattr(type(self), name)):
            members = ", ".join(member for member, _ in self._fields_)
            raise AttributeError(f"{type(self).__name__} has no member {name!r}; it has {members}")
        super().__setattr__(name, value)

    def __repr__(self):
        shown = []
        for name, kind in self._fields_:
            value = getattr(self, name)
            shown.append(f"{name}={list(value) if isinstance(value, ctypes.Array) else value!r}")
        return f"{type(self).__name__}({', '.join(shown)})"


def structure(name, **fields):
    return type(name, (Structure,), {"_fields_": list(fields.items()), "__module__": __name__})


Brick = structure("Brick", n=c_size_t, space=c_int32, start=c_size_t * 3, count=c_size_t * 3, stride=c_size_t * 3)
Layout = structure("Layout", size=c_size_t, align=c_size_t)

Body = ctypes.CFUNCTYPE(None, c_void_p, c_size_t)
ParallelFor = ctypes.CFUNCTYPE(c_int32, c_void_p, c_size_t, Body, c_void_p)
Exec = structure("Exec", context=c_void_p, parallel_for=ParallelFor)
Pass = ctypes.CFUNCTYPE(c_int32, c_void_p, c_void_p)
Sum = ctypes.CFUNCTYPE(c_int32, c_void_p, ctypes.POINTER(c_double), c_size_t)
Fft = structure("Fft", struct_size=c_size_t, context=c_void_p, forward=Pass, inverse=Pass, sum=Sum,
                configuration=Brick, fourier=Brick, length=c_size_t)

Realisation = structure("Realisation", struct_size=c_size_t, seed=c_uint64, scheme=c_int32, amplitude=c_int32,
                        phase=c_int32, nyquist=c_int32, selection=c_int32, sample=c_uint32)
Cosmology = structure("Cosmology", struct_size=c_size_t, omega_m=c_double, omega_de=c_double, omega_r=c_double,
                      omega_b=c_double, h=c_double, n_s=c_double, w0=c_double, wa=c_double, t_cmb=c_double)
Growth = structure("Growth", **dict.fromkeys("d f d2 f2 d3a f3a d3b f3b d3c f3c".split(), c_double))
Linear = structure("Linear", struct_size=c_size_t, source=c_int32, normalisation=c_int32, k=c_void_p, value=c_void_p,
                   rows=c_size_t, amount=c_double)
Species = structure("Species", struct_size=c_size_t, rows=c_size_t, k=c_void_p, matter=c_void_p, density=c_void_p,
                    velocity=c_void_p, reference=c_void_p)
ShapeRow = structure("ShapeRow", coefficient=c_double, s_out=c_double, s_a=c_double, s_b=c_double)
Conditions = structure("Conditions", struct_size=c_size_t, realisation=Realisation, cosmology=Cosmology, linear=Linear,
                       redshift=c_double, box_size=c_double, f_nl=c_double, g_nl=c_double, convention=c_int32,
                       order=c_int32, shape=c_int32, rows_len=c_size_t, rows=c_void_p, species=c_void_p)

Components = structure("Components", x=c_void_p, y=c_void_p, z=c_void_p, stride=c_size_t, length=c_size_t)
Positions = structure("Positions", x=c_void_p, y=c_void_p, z=c_void_p, stride=c_size_t, length=c_size_t)

ForceLaw = structure("ForceLaw", struct_size=c_size_t, laplacian=c_int32, gradient=c_int32, window=c_int32,
                     window_power=c_int32, split_scale=c_double)
StepFactors = structure("StepFactors", factor=c_double, first=c_double, second=c_double)
Gravity = structure("Gravity", struct_size=c_size_t, cosmology=Cosmology, box_size=c_double, hubble=c_double, law=ForceLaw,
                    cola_exponent=c_double, stepper=c_int32, window=c_int32)
Epoch = structure("Epoch", position=c_double, velocity=c_double)
Displacements = structure("Displacements", first=Positions, second=Positions, scale_factor=c_double)
Outputs = structure("Outputs", scale_factors=c_void_p, length=c_size_t, position=Components, velocity=Components)
Progress = structure("Progress", event=c_int32, step=c_size_t, steps=c_size_t, output=c_size_t, epoch=Epoch)
Observe = ctypes.CFUNCTYPE(c_int32, c_void_p, ctypes.POINTER(Progress))
Observer = structure("Observer", context=c_void_p, observe=Observe)

Halo = structure("Halo", label=c_uint64, members=c_uint64, mass=c_double, centre=c_double * 3, velocity=c_double * 3,
                 radius=c_double, extent=c_double * 3, velocity_dispersion=c_double)
HaloSums = structure("HaloSums", label=c_uint64, members=c_uint64, reference=c_double * 3, reference_velocity=c_double * 3,
                     position=c_double * 3, position_squared=c_double, velocity=c_double * 3, velocity_squared=c_double,
                     low=c_double * 3, high=c_double * 3)
Sphere = structure("Sphere", members=c_uint64, mass=c_double, radius=c_double)

Binning = structure("Binning", struct_size=c_size_t, edges=c_void_p, edges_len=c_size_t, second=c_int32, orders=c_uint32,
                    second_edges=c_void_p, second_edges_len=c_size_t, axis=c_double * 3)
Bin = structure("Bin", count=c_uint64, first=c_double, second=c_double)

Suppression = structure("Suppression", cosmic_variance=c_double, softening=c_double, shot_noise=c_double)
SuppressionFit = structure("SuppressionFit", value=Suppression, error=Suppression, covariance=c_double * 9,
                           chi_squared=c_double, degrees=c_uint64)
Bias = structure("Bias", b_g=c_double, p=c_double, f_nl=c_double, delta_c=c_double)
# The root is double[6][6] in the header.
BiasLikelihood = structure("BiasLikelihood", bins=c_uint64, root=c_double * 36)
BiasFit = structure("BiasFit", value=Bias, error=c_double * 3, covariance=c_double * 9, chi_squared=c_double, degrees=c_uint64)
Posterior = structure("Posterior", peak=c_double, mean=c_double, deviation=c_double, low=c_double, high=c_double,
                      centre=c_double, half_width=c_double, edge=c_double)
# fixpair_difference: the differences of a Laplacian have that name here.
DifferenceOfMatched = structure("DifferenceOfMatched", mean_first=c_double, mean_second=c_double, deviation_first=c_double,
                                deviation_second=c_double, correlation=c_double, correlation_error=c_double, mean=c_double,
                                deviation=c_double, error_of_mean=c_double)
ControlVariate = structure("ControlVariate", mean=c_double, error=c_double, beta=c_double, correlation=c_double,
                           deviation=c_double, gain=c_double)
