//! Lines of one level.

use core::f64::consts::{PI, TAU};
use std::collections::BTreeMap;
use std::vec;
use std::vec::Vec;

use super::likelihood::{Data, TRUTH};
use crate::status::Error;
use crate::variance::bias::Spectrum;
use crate::variance::contours::contours;
use crate::variance::fit::{FREE_B_G, FREE_F_NL, fit_bias};
use crate::variance::posterior::{Grid, bias_grid};

fn grid(points: [usize; 2], range: [[f64; 2]; 2], of: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let value = |axis: usize, i: usize| {
        range[axis][0] + (range[axis][1] - range[axis][0]) * (i as f64 / (points[axis] - 1) as f64)
    };
    (0..points[0] * points[1]).map(|at| of(value(0, at / points[1]), value(1, at % points[1]))).collect()
}

fn lines(values: &[f64], points: [usize; 2], range: [[f64; 2]; 2], level: f64) -> Vec<[f64; 4]> {
    let count = contours(&mut [], values, points, range, level).unwrap();
    let mut segments = vec![[f64::NAN; 4]; count];
    assert_eq!(contours(&mut segments, values, points, range, level), Ok(count));
    segments
}

/// How many segments end at each point.
fn ends(segments: &[[f64; 4]]) -> BTreeMap<[u64; 2], usize> {
    let mut ends = BTreeMap::new();
    for [x0, y0, x1, y1] in segments {
        for end in [[x0, y0], [x1, y1]] {
            *ends.entry(end.map(|x| x.to_bits())).or_default() += 1;
        }
    }
    ends
}

/// Of the closed lines; positive where higher values are outside, by the side that the segments keep them on.
fn area(segments: &[[f64; 4]]) -> f64 {
    segments.iter().map(|[x0, y0, x1, y1]| 0.5 * (x0 * y1 - x1 * y0)).sum()
}

const SQUARE: [[f64; 2]; 2] = [[-1.5, 1.7], [-1.3, 1.4]];

#[test]
fn a_circle_is_closed_and_round() {
    for points in [[20, 30], [41, 37], [160, 140]] {
        let values = grid(points, SQUARE, |x, y| x * x + y * y);
        let segments = lines(&values, points, SQUARE, 1.0);
        assert!(ends(&segments).values().all(|&count| count == 2), "bit for bit");
        // A quadratic between points a step h apart is h^2/4 from its chord at most, and its slope on the circle is 2.
        let step = (3.2 / (points[0] - 1) as f64).max(2.7 / (points[1] - 1) as f64);
        for [x0, y0, x1, y1] in &segments {
            for radius in [x0.hypot(*y0), x1.hypot(*y1)] {
                assert!((radius - 1.0).abs() < 0.13 * step * step, "{points:?} {radius}");
            }
        }
        let length: f64 = segments.iter().map(|[x0, y0, x1, y1]| (x1 - x0).hypot(y1 - y0)).sum();
        assert!((length / TAU - 1.0).abs() < 0.5 * step * step);
        assert!((area(&segments).abs() / PI - 1.0).abs() < 0.5 * step * step);
    }
}

#[test]
fn higher_values_are_on_the_same_side_of_every_segment() {
    let points = [60, 50];
    let of = |x: f64, y: f64| (3.0 * x).sin() * (2.0 * y).cos() + 0.3 * x;
    let values = grid(points, SQUARE, of);
    let segments = lines(&values, points, SQUARE, 0.2);
    assert!(segments.len() > 50);
    let right = segments.iter().filter(|[x0, y0, x1, y1]| {
        let (middle, along) = ([0.5 * (x0 + x1), 0.5 * (y0 + y1)], [x1 - x0, y1 - y0]);
        let length = along[0].hypot(along[1]);
        let side = |by: f64| of(middle[0] + by * along[1] / length, middle[1] - by * along[0] / length);
        side(0.02) > side(-0.02)
    });
    let right = right.count();
    assert!(right == 0 || right == segments.len(), "{right} of {}", segments.len());
}

#[test]
fn a_line_that_leaves_the_grid_ends_on_its_border() {
    let points = [33, 29];
    let values = grid(points, SQUARE, |x, y| x + 0.3 * y * y);
    let segments = lines(&values, points, SQUARE, 0.1);
    let loose: Vec<[f64; 2]> = ends(&segments)
        .into_iter()
        .filter(|&(_, count)| count == 1)
        .map(|(end, _)| end.map(f64::from_bits))
        .collect();
    assert_eq!(loose.len(), 2);
    // The last value of a range is its first and all steps, rounded.
    let on = |x: f64, axis: usize| SQUARE[axis].iter().any(|border| (x - border).abs() < 1e-15);
    assert!(loose.iter().all(|end| on(end[0], 0) || on(end[1], 1)));
}

#[test]
fn a_saddle_is_decided_by_its_middle() {
    let range = [[0.0, 1.0]; 2];
    for (high, joined) in [(2.0, true), (0.5, false)] {
        // High corners (0, 0) and (1, 1); the low ones are at -1.
        let segments = lines(&[high, -1.0, -1.0, high], [2, 2], range, 0.0);
        assert_eq!(segments.len(), 2);
        for [x0, y0, x1, y1] in segments {
            // Each cuts off one corner: of the low ones (x > y or x < y throughout) or of the high ones (x + y off 1).
            let cuts_low = (x0 - y0) * (x1 - y1) > 0.0;
            assert_eq!(cuts_low, joined);
        }
    }
}

#[test]
fn random_heights_make_lines_without_loose_ends() {
    let mut draws = super::Draws::of(91);
    let points = [24, 31];
    for _ in 0..50 {
        // Low on the border, so that all lines close; integers, so that the level is met exactly too.
        let mut values = vec![-1.0; 24 * 31];
        for i in 1..23 {
            for j in 1..30 {
                values[31 * i + j] = draws.below(5) as f64 - 2.0;
            }
        }
        let segments = lines(&values, points, SQUARE, 0.0);
        // A point at the level itself is where all lines through it meet: an even number of ends.
        assert!(ends(&segments).values().all(|count| count % 2 == 0));
        assert!(segments.as_flattened().iter().all(|x| x.is_finite()));
    }
}

#[test]
fn delta_chi_squared_of_one_encloses_pi_root_det_of_the_covariance() {
    // Errors of 1e-4 of the parameters, so that chi^2 is quadratic.
    let likelihood = Data::exact(&TRUTH, Spectrum::HaloHalo, 1e-4).likelihood(Spectrum::HaloHalo);
    let fit = fit_bias(&likelihood, &TRUTH, FREE_B_G | FREE_F_NL).unwrap();
    let c = fit.covariance;
    let range = [0, 2].map(|number: usize| {
        let value = [fit.value.b_g, 0.0, fit.value.f_nl][number];
        [value - 1.5 * fit.error[number], value + 1.5 * fit.error[number]]
    });
    let points = [400, 400];
    let mut values = vec![0.0; 400 * 400];
    bias_grid(&mut values, &likelihood, &TRUTH, FREE_B_G | FREE_F_NL, &Grid { range, points }).unwrap();
    let segments = lines(&values, points, range, fit.chi_squared + 1.0);
    // About the centre, lest digits be lost.
    let shifted: Vec<[f64; 4]> = segments
        .iter()
        .map(|[x0, y0, x1, y1]| {
            let (x, y) = (fit.value.b_g, fit.value.f_nl);
            [x0 - x, y0 - y, x1 - x, y1 - y]
        })
        .collect();
    let expected = PI * (c[0] * c[8] - c[2] * c[6]).sqrt();
    // Steps of 1/133 of an error, an ellipse several times thinner than long.
    assert!((area(&shifted).abs() / expected - 1.0).abs() < 1e-3, "{} {expected}", area(&shifted));
}

#[test]
fn nothing_is_written_where_there_is_no_room() {
    let points = [20, 30];
    let values = grid(points, SQUARE, |x, y| x * x + y * y);
    let count = contours(&mut [], &values, points, SQUARE, 1.0).unwrap();
    let mut short = vec![[7.0; 4]; count - 1];
    assert_eq!(contours(&mut short, &values, points, SQUARE, 1.0), Err(Error::Length));
    assert!(short.as_flattened().iter().all(|&x| x == 7.0));
    let mut long = vec![[7.0; 4]; count + 2];
    assert_eq!(contours(&mut long, &values, points, SQUARE, 1.0), Ok(count));
    assert_eq!(long[count..], [[7.0; 4]; 2]);
    assert_eq!(contours(&mut [], &values, points, SQUARE, 100.0), Ok(0));
    let refused =
        |values: &[f64], points, range, level| contours(&mut [], values, points, range, level).unwrap_err();
    assert_eq!(refused(&values[1..], points, SQUARE, 1.0), Error::Length);
    assert_eq!(refused(&values, [1, 600], SQUARE, 1.0), Error::Range);
    assert_eq!(refused(&values, [usize::MAX, 2], SQUARE, 1.0), Error::Overflow);
    assert_eq!(refused(&values, points, [[1.0, 1.0], [0.0, 1.0]], 1.0), Error::Range);
    assert_eq!(refused(&values, points, [[0.0, f64::NAN], [0.0, 1.0]], 1.0), Error::NotFinite);
    assert_eq!(refused(&values, points, SQUARE, f64::INFINITY), Error::NotFinite);
    let mut hole = values.clone();
    hole[77] = f64::NAN;
    assert_eq!(refused(&hole, points, SQUARE, 1.0), Error::NotFinite);
}
