//! Everything that is measured and drawn, as CSV.

use std::fmt::Write as _;

use crate::late_statistics::{Tracer, groups, have_halos, late_band, mean_k, relative};
use crate::statistics::{Kind, band, power_difference, quadratic_mean, squeezed_band};
use crate::suite::{Amplitude, Half, Phase, Suite, Variant};

/// Name and content of each CSV file.
pub(crate) fn tables(suite: &Suite) -> [(&'static str, String); 8] {
    [
        ("power.csv", power_csv(suite)),
        ("bispectrum.csv", bispectrum_csv(suite)),
        ("multipoles.csv", multipoles_csv(suite)),
        ("squeezed.csv", squeezed_csv(suite)),
        ("summary.csv", summary_csv(suite)),
        ("power_z1.csv", late_power_csv(suite)),
        ("bispectrum_z1.csv", late_bispectrum_csv(suite)),
        ("summary_z1.csv", late_summary_csv(suite)),
    ]
}

/// Every seed and variant, in the order in which they were made.
fn each(suite: &Suite) -> impl Iterator<Item = (usize, Variant, String)> {
    (0..suite.seeds.len()).flat_map(move |place| {
        Variant::all().into_iter().map(move |variant| {
            let [amplitude, phase] = variant.names();
            let fnl = suite.configuration.fnl_of(variant.half);
            (place, variant, format!("{},{amplitude},{phase},{fnl}", suite.seeds[place]))
        })
    })
}

fn power_csv(suite: &Suite) -> String {
    let mut csv =
        String::from("seed,amplitude,phase,f_NL,k [h/Mpc],modes,linear P [(Mpc/h)^3],P [(Mpc/h)^3]\n");
    let bins = suite.bins();
    for (place, variant, names) in each(suite) {
        let power = &suite.get(place, variant).early.power;
        for (((k, modes), theory), power) in bins.k.iter().zip(&bins.modes).zip(&bins.theory).zip(power) {
            let _ = writeln!(csv, "{names},{k},{modes},{theory},{power}");
        }
    }
    csv
}

fn bispectrum_csv(suite: &Suite) -> String {
    let mut csv = String::from(
        "seed,amplitude,phase,f_NL,k [h/Mpc],triples of modes,linear B for f_NL = 1 [(Mpc/h)^6],B [(Mpc/h)^6]\n",
    );
    let slice = &suite.bins().squeezed;
    for (place, variant, names) in each(suite) {
        for (i, value) in suite.get(place, variant).early.squeezed.iter().enumerate() {
            let (k, count, template) = (slice.k[i], slice.count[i], slice.template[i]);
            let _ = writeln!(csv, "{names},{k},{count},{template},{value}");
        }
    }
    csv
}

fn multipoles_csv(suite: &Suite) -> String {
    let mut csv = String::from(
        "seed,amplitude,phase,f_NL,k [h/Mpc],modes,P_0 [(Mpc/h)^3],P_2 [(Mpc/h)^3],P_4 [(Mpc/h)^3]\n",
    );
    let bins = suite.bins();
    for (place, variant, names) in each(suite) {
        let Some([p0, p2, p4]) = &suite.get(place, variant).early.multipoles else { continue };
        for (i, (k, modes)) in bins.k.iter().zip(&bins.modes).enumerate() {
            let _ = writeln!(csv, "{names},{k},{modes},{},{},{}", p0[i], p2[i], p4[i]);
        }
    }
    csv
}

fn squeezed_csv(suite: &Suite) -> String {
    let mut csv = String::from("seed,amplitude,phase,f_NL,f_NL measured\n");
    for (place, variant, names) in each(suite) {
        let _ = writeln!(csv, "{names},{}", suite.get(place, variant).early.fnl);
    }
    csv
}

/// Mean and scatter of each type, bin by bin, with sigma/sigma_th of matched differences.
fn summary_csv(suite: &Suite) -> String {
    let bins = suite.bins();
    let mut csv = String::from(
        "quantity,type,f_NL,k [h/Mpc],modes or triples,mean,standard deviation,sigma/sigma_th\n",
    );
    for half in [Half::Gaussian, Half::Local] {
        let fnl = suite.configuration.fnl_of(half);
        for kind in Kind::ALL {
            let band = band(suite, kind, half);
            for (i, (k, modes)) in bins.k.iter().zip(&bins.modes).enumerate() {
                let (mean, deviation, ratio) = (band.mean[i], band.deviation[i], band.ratio[i]);
                let _ = writeln!(csv, "P,{},{fnl},{k},{modes},{mean},{deviation},{ratio}", kind.name());
            }
        }
    }
    let slice = &bins.squeezed;
    for half in [Half::Gaussian, Half::Local] {
        let fnl = suite.configuration.fnl_of(half);
        for kind in Kind::ALL {
            let band = squeezed_band(suite, kind, half);
            for (i, (k, triples)) in slice.k.iter().zip(&slice.count).enumerate() {
                let (mean, deviation, ratio) = (band.mean[i], band.deviation[i], band.ratio[i]);
                let _ = writeln!(csv, "B,{},{fnl},{k},{triples},{mean},{deviation},{ratio}", kind.name());
            }
        }
    }
    for kind in Kind::ALL {
        for (name, matched) in [("matched difference of P", true), ("unmatched difference of P", false)] {
            let ratio = power_difference(suite, kind, matched).ratio;
            for ((k, modes), ratio) in bins.k.iter().zip(&bins.modes).zip(ratio) {
                let _ =
                    writeln!(csv, "{name},{},{},{k},{modes},,,{ratio}", kind.name(), suite.configuration.fnl);
            }
        }
    }
    csv
}

fn late_power_csv(suite: &Suite) -> String {
    let mut csv = String::from(
        "seed,amplitude,phase,f_NL,k [h/Mpc],modes,linear P [(Mpc/h)^3],P of matter [(Mpc/h)^3],\
         P of halos less shot noise [(Mpc/h)^3],halos\n",
    );
    let bins = suite.bins();
    for (place, variant, names) in each(suite) {
        let late = &suite.get(place, variant).late;
        for (i, (k, modes)) in bins.k.iter().zip(&bins.modes).enumerate() {
            let (theory, matter, halos) = (bins.late_theory[i], late.matter[i], late.halos[i]);
            let _ = writeln!(csv, "{names},{k},{modes},{theory},{matter},{halos},{}", late.count);
        }
    }
    csv
}

fn late_bispectrum_csv(suite: &Suite) -> String {
    let mut csv = String::from(
        "seed,amplitude,phase,f_NL,k [h/Mpc],triples of modes,linear B for f_NL = 1 [(Mpc/h)^6],B of matter [(Mpc/h)^6],\
         B of halos less shot noise [(Mpc/h)^6]\n",
    );
    let slice = &suite.bins().squeezed;
    for (place, variant, names) in each(suite) {
        let late = &suite.get(place, variant).late;
        for (i, (k, count)) in slice.k.iter().zip(&slice.count).enumerate() {
            let template = suite.bins().squeezed_growth * slice.template[i];
            let (matter, halos) = (late.matter_squeezed[i], late.halo_squeezed[i]);
            let _ = writeln!(csv, "{names},{k},{count},{template},{matter},{halos}");
        }
    }
    csv
}

/// The figures at z = 1: means over the mean of Normal-Original with their errors, and sigma/sigma_th in the figures' groups of bins.
fn late_summary_csv(suite: &Suite) -> String {
    let bins = suite.bins();
    let mut csv = String::from("quantity,of,type,f_NL,k [h/Mpc],value,error\n");
    for tracer in Tracer::ALL.into_iter().filter(|tracer| *tracer == Tracer::Matter || have_halos(suite)) {
        for half in [Half::Gaussian, Half::Local] {
            let (name, fnl) = (tracer.name(), suite.configuration.fnl_of(half));
            for (amplitude, phase) in [
                (Amplitude::Normal, Phase::Original),
                (Amplitude::Fixed, Phase::Original),
                (Amplitude::Normal, Phase::Inverted),
                (Amplitude::Fixed, Phase::Inverted),
            ] {
                let [amplitude_name, phase_name] = Variant { amplitude, phase, half }.names();
                for range in groups(&bins.k) {
                    let k = mean_k(bins, &range);
                    let ratio = relative(suite, tracer, Variant { amplitude, phase, half }, &range);
                    let _ = writeln!(
                        csv,
                        "P/P_Normal-Original,{name},{amplitude_name}-{phase_name},{fnl},{k},{},{}",
                        ratio.value, ratio.error
                    );
                }
            }
            for kind in Kind::ALL {
                let band = late_band(suite, tracer, kind, half);
                for range in groups(&bins.k) {
                    let (k, value) = (mean_k(bins, &range), quadratic_mean(&band.ratio[range.clone()]));
                    let _ = writeln!(csv, "sigma/sigma_th,{name},{},{fnl},{k},{value},", kind.name());
                }
            }
        }
    }
    csv
}
