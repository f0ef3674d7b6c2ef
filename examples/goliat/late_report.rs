//! What the suite says about z = 1: means and scatter of the spectra of halos and matter, and squeezed bispectra.

use std::fmt::Write as _;
use std::ops::Range;

use crate::late::{LEAST, mass};
use crate::late_statistics::{
    Estimate, SQUEEZED_REACH, Tracer, bias, expected_response, halo_count, have_halos, inverted, late_band,
    relative, response, squeezed_amplitude,
};
use crate::report::sigma_text;
use crate::statistics::{Kind, differences, error_of_mean, estimates, mean, quadratic_mean, ranges};
use crate::suite::{Amplitude, Half, Phase, Suite, Variant};
use crate::universe::END;

const AMPLITUDES: [(Amplitude, &str); 2] = [(Amplitude::Normal, "Normal"), (Amplitude::Fixed, "Fixed")];

pub(crate) fn write(text: &mut String, suite: &Suite) {
    let configuration = &suite.configuration;
    let mass = mass(configuration.size, configuration.length).map_or(f64::NAN, |mass| LEAST as f64 * mass);
    let [gaussian, local] = [Half::Gaussian, Half::Local].map(|half| halo_count(suite, half));
    let _ = write!(
        text,
        "\nHalos at z = {END}: of {LEAST} particles ({mass:.1e} Msun/h) and more; {gaussian:.0} in a universe of f_NL = 0, \
         {local:.0} of f_NL = {}; ",
        configuration.fnl
    );
    let tracers = if have_halos(suite) {
        let _ = writeln!(text, "bias {:.2}", bias(suite));
        &Tracer::ALL[..]
    } else {
        text.push_str("too few for spectra:\na smaller --box or a larger --size has more\n");
        &Tracer::ALL[1..]
    };
    mean_table(text, suite, tracers);
    scatter_table(text, suite, tracers);
    squeezed_table(text, suite, tracers);
}

/// The head of a table with three ranges of k for each tracer.
fn head(text: &mut String, suite: &Suite, tracers: &[Tracer], width: usize) -> [Range<usize>; 3] {
    let bins = suite.bins();
    let ranges = ranges(&bins.k);
    let _ = write!(text, "  {:<36}", "");
    for tracer in tracers {
        let _ = write!(text, "{:>1$}  ", format!("{}  ", tracer.name()), 3 * width);
    }
    let _ = write!(text, "\n  {:<32}", "k [h/Mpc] up to");
    for _ in tracers {
        for range in &ranges {
            let _ = write!(text, "{:>width$.3}", bins.k[range.end - 1]);
        }
        text.push_str("  ");
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    ranges
}

/// 1.234(56) for 1.234 +- 0.056.
fn bracketed(Estimate { value, error }: Estimate) -> String {
    if error.is_nan() { format!("{value:.3}    ") } else { format!("{value:.3}({:.0})", 1e3 * error) }
}

fn mean_table(text: &mut String, suite: &Suite, tracers: &[Tracer]) {
    const WIDTH: usize = 11;
    text.push_str("\nMeans at z = 1: ratios of power spectra, with the error of the last digits\n");
    let ranges = head(text, suite, tracers, WIDTH);
    let mut line = |title: &str, estimate: &dyn Fn(Tracer, &Range<usize>) -> Option<Estimate>| {
        let mut line = format!("  {title:<36}");
        for &tracer in tracers {
            for range in &ranges {
                let cell = estimate(tracer, range).map_or_else(String::new, bracketed);
                let _ = write!(line, "{cell:>WIDTH$}");
            }
            line.push_str("  ");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    };
    for half in [Half::Gaussian, Half::Local] {
        let fnl = suite.configuration.fnl_of(half);
        let fixed = Variant { amplitude: Amplitude::Fixed, phase: Phase::Original, half };
        line(&format!("f_NL = {fnl:<6} Fixed / Normal"), &|tracer, range| {
            Some(relative(suite, tracer, fixed, range))
        });
        for (amplitude, name) in AMPLITUDES {
            line(&format!("f_NL = {fnl:<6} {name}, Inv. / Orig."), &|tracer, range| {
                Some(inverted(suite, tracer, amplitude, half, range))
            });
        }
    }
    for (amplitude, name) in AMPLITUDES {
        line(&format!("{name}, f_NL = {} / 0, Matched", suite.configuration.fnl), &|tracer, range| {
            Some(response(suite, tracer, amplitude, range))
        });
    }
    if tracers.contains(&Tracer::Halos) {
        // Of matter the formula says nothing; and of halos not that f_NL > 0 makes those of one mass more common and so less biased.
        line("Eq. bk: the same b_g, and p = 1", &|tracer, range| {
            let value = expected_response(suite, range);
            (tracer == Tracer::Halos).then_some(Estimate { value, error: f64::NAN })
        });
    }
}

fn scatter_table(text: &mut String, suite: &Suite, tracers: &[Tracer]) {
    const WIDTH: usize = 9;
    text.push_str("\nScatter at z = 1, sigma / sigma_th per simulation, sigma_th = sqrt(2/N_k) (P + 1/n)\n");
    let ranges = head(text, suite, tracers, WIDTH);
    for half in [Half::Gaussian, Half::Local] {
        for kind in Kind::ALL {
            let title = format!("f_NL = {:<6} {}", suite.configuration.fnl_of(half), kind.name());
            let mut line = format!("  {title:<36}");
            for &tracer in tracers {
                let band = late_band(suite, tracer, kind, half);
                for range in &ranges {
                    let _ =
                        write!(line, "{:>WIDTH$}", sigma_text(quadratic_mean(&band.ratio[range.clone()])));
                }
                line.push_str("  ");
            }
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
}

fn squeezed_table(text: &mut String, suite: &Suite, tracers: &[Tracer]) {
    let _ = write!(
        text,
        "\nSqueezed bispectrum at z = 1, k below {SQUEEZED_REACH} h/Mpc, in units of linear\ntheory of matter for f_NL = 1: mean and its error\n"
    );
    let _ = write!(text, "  {:<36}", "");
    for tracer in tracers {
        let _ = write!(text, "{:>24}", tracer.name());
    }
    text.push('\n');
    let mut line = |title: &str, values: &dyn Fn(Tracer) -> Vec<f64>| {
        let _ = write!(text, "  {title:<36}");
        for &tracer in tracers {
            let values = values(tracer);
            let _ = write!(text, "{:>12.1} +/-{:>8.1}", mean(&values), error_of_mean(&values));
        }
        text.push('\n');
    };
    let of = |kind, half, tracer| {
        estimates(suite, kind, half, |one| squeezed_amplitude(&one.late, tracer, suite.bins()))
    };
    for half in [Half::Gaussian, Half::Local] {
        for kind in Kind::ALL {
            let title = format!("f_NL = {:<6} {}", suite.configuration.fnl_of(half), kind.name());
            line(&title, &|tracer| of(kind, half, tracer));
        }
    }
    for kind in Kind::ALL {
        line(&format!("difference, {}, Matched", kind.name()), &|tracer| {
            differences(&of(kind, Half::Local, tracer), &of(kind, Half::Gaussian, tracer), true)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_in_units_of_the_last_digit() {
        assert_eq!(bracketed(Estimate { value: 1.2344, error: 0.0561 }), "1.234(56)");
        assert_eq!(bracketed(Estimate { value: 1.0, error: f64::NAN }), "1.000    ");
    }
}
