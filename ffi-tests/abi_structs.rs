//! The structs of the interface as Rust lays them out.

use std::mem::{offset_of, size_of};

use fixpair::capi::{
    binning::fixpair_binning,
    cosmology::{fixpair_cosmology, fixpair_linear},
    exec::fixpair_exec,
    fft::{fixpair_fft_f32, fixpair_fft_f64},
    force::fixpair_force_law,
    initial::fixpair_conditions,
    mesh::fixpair_brick,
    noise::fixpair_realisation,
    particles::{fixpair_components_f32, fixpair_components_f64},
    pm::{fixpair_positions_f32, fixpair_positions_f64},
    run::{
        fixpair_displacements_f32, fixpair_displacements_f64, fixpair_gravity, fixpair_observer,
        fixpair_outputs_f32, fixpair_outputs_f64, fixpair_progress,
    },
    species::fixpair_species,
};
use fixpair::cosmology::Growth;
use fixpair::estimate::binning::Bin;
use fixpair::halos::{Halo, HaloSums, Sphere};
use fixpair::initial::shape::ShapeRow;
use fixpair::pm::{evolve::Epoch, factors::StepFactors};
use fixpair::scratch::Layout;
use fixpair::variance::{
    bias::Bias, control::ControlVariate, fit::BiasFit, likelihood::BiasLikelihood,
    matched::MatchedDifference, models::Suppression, posterior::Posterior, suppression::SuppressionFit,
};

/// Lines such as `struct NAME = SIZE bytes` and `member NAME.MEMBER = SIZE bytes at OFFSET`.
macro_rules! layouts {
    ($($name:literal $rust:ident { $($member:ident),+ })+) => {{
        let mut lines = Vec::new();
        $({
            lines.push(format!("struct {} = {} bytes, aligned to {}", $name, size_of::<$rust>(), align_of::<$rust>()));
            // No member is left out.
            let _ = |whole: $rust| { let $rust { $($member: _),+ } = whole; };
            $(lines.push(format!(
                "member {}.{} = {} bytes at {}",
                $name,
                stringify!($member),
                size_of_member(|whole: &$rust| &raw const whole.$member),
                offset_of!($rust, $member)
            ));)+
        })+
        lines
    }};
}

fn size_of_member<S, M>(_: impl Fn(&S) -> *const M) -> usize {
    size_of::<M>()
}

#[rustfmt::skip]
pub(crate) fn layouts() -> Vec<String> {
    layouts! {
        "fixpair_brick" fixpair_brick { n, space, start, count, stride }
        "fixpair_exec" fixpair_exec { context, parallel_for }
        "fixpair_fft_f64" fixpair_fft_f64 { struct_size, context, forward, inverse, sum, configuration,
            fourier, length }
        "fixpair_fft_f32" fixpair_fft_f32 { struct_size, context, forward, inverse, sum, configuration,
            fourier, length }
        "fixpair_layout" Layout { size, align }
        "fixpair_realisation" fixpair_realisation { struct_size, seed, scheme, amplitude, phase, nyquist,
            selection, sample }
        "fixpair_cosmology" fixpair_cosmology { struct_size, omega_m, omega_de, omega_r, omega_b, h, n_s, w0,
            wa, t_cmb }
        "fixpair_growth" Growth { d, f, d2, f2, d3a, f3a, d3b, f3b, d3c, f3c }
        "fixpair_linear" fixpair_linear { struct_size, source, normalisation, k, value, rows, amount }
        "fixpair_species" fixpair_species { struct_size, rows, k, matter, density, velocity, reference }
        "fixpair_shape_row" ShapeRow { coefficient, s_out, s_a, s_b }
        "fixpair_conditions" fixpair_conditions { struct_size, realisation, cosmology, linear, redshift,
            box_size, f_nl, g_nl, convention, order, shape, rows_len, rows, species }
        "fixpair_components_f64" fixpair_components_f64 { x, y, z, stride, length }
        "fixpair_components_f32" fixpair_components_f32 { x, y, z, stride, length }
        "fixpair_positions_f64" fixpair_positions_f64 { x, y, z, stride, length }
        "fixpair_positions_f32" fixpair_positions_f32 { x, y, z, stride, length }
        "fixpair_force_law" fixpair_force_law { struct_size, laplacian, gradient, window, window_power,
            split_scale }
        "fixpair_step_factors" StepFactors { factor, first, second }
        "fixpair_gravity" fixpair_gravity { struct_size, cosmology, box_size, hubble, law, cola_exponent,
            stepper, window }
        "fixpair_epoch" Epoch { position, velocity }
        "fixpair_displacements_f64" fixpair_displacements_f64 { first, second, scale_factor }
        "fixpair_outputs_f64" fixpair_outputs_f64 { scale_factors, length, position, velocity }
        "fixpair_progress" fixpair_progress { event, step, steps, output, epoch }
        "fixpair_observer" fixpair_observer { context, observe }
        "fixpair_displacements_f32" fixpair_displacements_f32 { first, second, scale_factor }
        "fixpair_outputs_f32" fixpair_outputs_f32 { scale_factors, length, position, velocity }
        "fixpair_halo" Halo { label, members, mass, centre, velocity, radius, extent, velocity_dispersion }
        "fixpair_halo_sums" HaloSums { label, members, reference, reference_velocity, position,
            position_squared, velocity, velocity_squared, low, high }
        "fixpair_sphere" Sphere { members, mass, radius }
        "fixpair_binning" fixpair_binning { struct_size, edges, edges_len, second, orders, second_edges,
            second_edges_len, axis }
        "fixpair_bin" Bin { count, first, second }
        "fixpair_suppression" Suppression { cosmic_variance, softening, shot_noise }
        "fixpair_suppression_fit" SuppressionFit { value, error, covariance, chi_squared, degrees }
        "fixpair_bias" Bias { b_g, p, f_nl, delta_c }
        "fixpair_bias_likelihood" BiasLikelihood { bins, root }
        "fixpair_bias_fit" BiasFit { value, error, covariance, chi_squared, degrees }
        "fixpair_posterior" Posterior { peak, mean, deviation, low, high, centre, half_width, edge }
        "fixpair_difference" MatchedDifference { mean_first, mean_second, deviation_first, deviation_second,
            correlation, correlation_error, mean, deviation, error_of_mean }
        "fixpair_control_variate" ControlVariate { mean, error, beta, correlation, deviation, gain }
    }
}
