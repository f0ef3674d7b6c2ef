//! Claims about how large each order is, in the one call.

use std::vec::Vec;

use super::conditions::{InitialConditions, Order};
use super::tests_species::{conditions, moved};
use crate::exec::Serial;

/// D, and displacements of each order alone.
fn orders(redshift: f64) -> (f64, [Vec<f64>; 3]) {
    let at = |order| InitialConditions { redshift, ..conditions(order, None) };
    let d = at(Order::First).poisson().unwrap().growth().d;
    let [first, second, third] = [Order::First, Order::Second, Order::Third].map(|order| {
        let [displacements, _] = moved(&at(order), &Serial);
        displacements
    });
    let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
    let (alone, last) = (minus(&second, &first), minus(&third, &second));
    (d, [first, alone, last])
}

fn rms(field: &[f64]) -> f64 {
    (field.iter().map(|x| x * x).sum::<f64>() / field.len() as f64).sqrt()
}

#[test]
fn each_order_is_smaller_than_the_last_and_grows_by_one_more_power() {
    let (early, late) = (orders(49.0), orders(24.0));
    let size = |orders: &[Vec<f64>; 3]| orders.each_ref().map(|x| rms(x));
    let (before, after) = (size(&early.1), size(&late.1));
    for [first, second, third] in [before, after] {
        // Cells of 33 Mpc/h: the second order is some 1e-3 of the first, and the third some 1e-2 of the second.
        assert!(second < 0.02 * first && third < 0.05 * second, "{first} {second} {third}");
    }
    let growth = late.0 / early.0;
    for order in 0..3 {
        // D2/D^2 and D3/D^3 differ by 3e-5 between the two times; the third is 1e-7 of the positions that it is the difference of.
        let expected = growth.powi(order as i32 + 1);
        assert!((after[order] / before[order] / expected - 1.0).abs() < 1e-4, "{order} {before:?} {after:?}");
    }
}
