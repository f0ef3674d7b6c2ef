//! Reads the spectra that Boltzmann codes write, for the examples. Not an example of its own.
//!
//! Recognised by the number of columns; lines that begin with `#` are comments:
//!
//! | columns | written by | read |
//! |---|---|---|
//! | 13 | CAMB, `transfer_out` | 1: k in h/Mpc, 7: total matter, delta/k^2 |
//! | 7 | CAMB before 2014 | the same |
//! | 2 | CAMB, `matterpower`; CLASS, `pk` | 1: k in h/Mpc, 2: P in (Mpc/h)^3 |
//! | 5 | `examples/data/camb_goliat_linear.txt` | 1: k, 3: P at z = 0 |
//!
//! Spectra are those of z = 0, which the library scales back with the growth of the simulation: a CLASS header with another redshift
//! is refused.

use std::path::Path;

/// What the second column of a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// P(k) at z = 0 in (Mpc/h)^3.
    Power,
    /// T(k) of total matter, in a unit that `Linear::from_transfer` divides out.
    Transfer,
}

/// The two columns of a spectrum, k in h/Mpc.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spectrum {
    /// What `value` is.
    pub(crate) kind: Kind,
    /// Wavenumbers, increasing.
    pub(crate) k: Vec<f64>,
    /// P or T at each of them, positive.
    pub(crate) value: Vec<f64>,
}

/// CAMB's spectrum of the paper's cosmology (sigma8 = 0.8, n_s = 0.96), which is part of the program.
pub(crate) fn embedded() -> Result<Spectrum, String> {
    parse("camb_goliat_linear.txt", include_str!("../data/camb_goliat_linear.txt"))
}

/// Reads a file of one of the formats above.
pub(crate) fn read(path: &Path) -> Result<Spectrum, String> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|error| format!("{name}: {error}: pass a spectrum that CAMB or CLASS wrote"))?;
    parse(&name, &text)
}

/// Reads `text`; `name` is for messages.
pub(crate) fn parse(name: &str, text: &str) -> Result<Spectrum, String> {
    let mut columns = 0;
    let mut spectrum = Spectrum { kind: Kind::Power, k: Vec::new(), value: Vec::new() };
    for (index, line) in text.lines().enumerate() {
        let here = |problem: String| format!("{name}, line {}: {problem}", index + 1);
        let line = line.trim();
        if let Some(comment) = line.strip_prefix('#') {
            check_comment(comment).map_err(here)?;
            continue;
        }
        if line.is_empty() {
            continue;
        }
        let row = line.split_whitespace().map(number).collect::<Result<Vec<f64>, _>>().map_err(here)?;
        if columns == 0 {
            columns = row.len();
        }
        if row.len() != columns {
            return Err(here(format!(
                "{} columns after rows of {columns}: is the file complete?",
                row.len()
            )));
        }
        let (kind, column) = match columns {
            2 => (Kind::Power, 1),
            5 => (Kind::Power, 2),
            7 | 13 => (Kind::Transfer, 6),
            other => {
                return Err(here(format!(
                    "{other} columns: pass CAMB's transfer (13 or 7 columns) or matterpower file, or CLASS's pk file (2 columns)"
                )));
            }
        };
        let (k, value) = (row[0], row[column]);
        if !(k.is_finite() && k > 0.0 && value.is_finite() && value > 0.0) {
            return Err(here(format!("k = {k}, value {value}: both must be positive; remove the row")));
        }
        if spectrum.k.last().is_some_and(|&last| k <= last) {
            return Err(here(format!("k = {k} does not increase: sort the rows and remove repeated ones")));
        }
        spectrum.kind = kind;
        spectrum.k.push(k);
        spectrum.value.push(value);
    }
    if spectrum.k.len() < 2 {
        return Err(format!("{name}: fewer than two rows: is this a spectrum?"));
    }
    Ok(spectrum)
}

fn number(word: &str) -> Result<f64, String> {
    // Fortran may write 1.0D-05.
    let plain = word.replace(['D', 'd'], "e");
    plain.parse().map_err(|_| format!("`{word}` is not a number: comments begin with #"))
}

/// CLASS says in its header what the columns are and at which redshift.
fn check_comment(comment: &str) -> Result<(), String> {
    if comment.contains("k (1/Mpc)") {
        return Err("k in 1/Mpc: have the code write k in h/Mpc and P in (Mpc/h)^3".into());
    }
    if let Some((_, rest)) = comment.split_once("at redshift z=") {
        let digits: String =
            rest.chars().take_while(|c| c.is_ascii_digit() || ".eE+-".contains(*c)).collect();
        if digits.trim_end_matches('.').parse::<f64>().is_ok_and(|z| z != 0.0) {
            return Err(format!(
                "a spectrum of z = {digits}: pass that of z = 0, which is scaled back by growth"
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of CAMB 2.0.5, the paper's cosmology.
    const NEW: &str = "\
#          k/h            CDM         baryon         photon             nu        mass_nu          total          no_nu       total_de           Weyl          v_CDM            v_b        v_b-v_c
    9.86413E-06    2.06370E+07    2.06370E+07    2.75015E+07    2.75011E+07    0.00000E+00    2.06370E+07    2.06370E+07    2.06457E+07   -4.56199E-01    9.97295E+06    9.97294E+06    6.40483E+00
    1.03685E-05    2.06370E+07    2.06370E+07    2.75000E+07    2.74996E+07    0.00000E+00    2.06369E+07    2.06370E+07    2.06457E+07   -4.56199E-01    9.97294E+06    9.97294E+06    6.73222E+00
";

    fn problem(text: &str) -> String {
        parse("file", text).unwrap_err()
    }

    #[test]
    fn camb_transfer_files_of_both_ages_are_read() {
        let new = parse("new", NEW).unwrap();
        assert_eq!(new.kind, Kind::Transfer);
        assert_eq!((new.k[1], new.value[1]), (1.03685e-5, 2.06369e7));
        let rows = NEW.lines().skip(1);
        let old: String =
            rows.map(|row| row.split_whitespace().take(7).collect::<Vec<_>>().join(" ") + "\n").collect();
        assert_eq!(parse("old", &old).unwrap(), new);
    }

    #[test]
    fn power_files_of_camb_and_class_are_read() {
        let camb = parse("camb", "#  k/h    P\n  1.0E-04  4.5E+02\n  0.2D-03  9.1D+02\n").unwrap();
        assert_eq!(camb, Spectrum { kind: Kind::Power, k: vec![1e-4, 2e-4], value: vec![450.0, 910.0] });
        let class = "# Matter power spectrum P(k) at redshift z=0\n# for k=1e-4 to 2e-4 h/Mpc,\n# number of wavenumbers equal to 2\n\
                     #    1:k (h/Mpc)              2:P (Mpc/h)^3\n 1.0e-04 450.0\n 2.0e-04 910.0\n\n";
        assert_eq!(parse("class", class).unwrap(), camb);
    }

    #[test]
    fn the_embedded_spectrum_is_whole() {
        let spectrum = embedded().unwrap();
        assert_eq!((spectrum.kind, spectrum.k.len(), spectrum.value.len()), (Kind::Power, 700, 700));
        assert_eq!(spectrum.value[0], 6.168_584_433_8e1);
    }

    #[test]
    fn files_are_read_from_disk() {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/camb_goliat_linear.txt");
        assert_eq!(read(&data), embedded());
        assert!(read(Path::new("no such file")).unwrap_err().starts_with("no such file: "));
    }

    #[test]
    fn messages_say_where_and_what_to_do() {
        assert!(problem("1 2\n3 x\n").starts_with("file, line 2: `x` is not a number"));
        assert!(problem("# a\n1 2\n3\n").starts_with("file, line 3: 1 columns after rows of 2"));
        assert!(problem("1 2 3\n").contains("3 columns: pass CAMB's"));
        assert!(problem("2 1\n1 1\n").contains("line 2: k = 1 does not increase"));
        assert!(problem("1 1\n2 -1\n").contains("must be positive"));
        assert!(problem("1 1\n2 nan\n").contains("must be positive"));
        assert!(problem("").contains("fewer than two rows"));
        assert!(problem("# P(k) at redshift z=32\n1 1\n2 1\n").contains("pass that of z = 0"));
        assert!(problem("# 1:k (1/Mpc) 2:P\n1 1\n2 1\n").contains("h/Mpc"));
    }
}
