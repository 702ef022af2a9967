//! The few loops that all time goes to.
//!
//! Always inlined, so that they are compiled for the vector unit that [`super::Network::logits_of`] has found. Where that fuses products with sums ([`Fused`]) it is used: half
//! the instructions, and other last bits than on a unit without.
#![expect(clippy::inline_always, reason = "a call would leave the vector unit that was dispatched to")]

use super::Layer;

/// How a product is added to a sum.
pub trait Sum {
    /// `sum + x · w`.
    fn add(sum: f32, x: f32, w: f32) -> f32;
}

/// Rounded once: for units that have an instruction for it.
pub struct Fused;

/// Rounded twice: for all others, where fusing would be a call.
pub struct Apart;

impl Sum for Fused {
    #[inline(always)]
    fn add(sum: f32, x: f32, w: f32) -> f32 {
        x.mul_add(w, sum)
    }
}

impl Sum for Apart {
    #[inline(always)]
    fn add(sum: f32, x: f32, w: f32) -> f32 {
        sum + x * w
    }
}

/// Outputs that are summed side by side, as long as there are so many; then half of them.
const LANES: usize = 16;
const HALF: usize = LANES / 2;
/// Rows that share a reading of the weights.
const ROWS: usize = 4;

/// `out_r = x_r W + b` for `rows` rows: row r of the input begins at `r · stride` (they may overlap: a convolution is that), row r of the output at `r · out_stride`.
#[inline(always)]
pub fn affine<S: Sum>(
    layer: &Layer,
    x: &[f32],
    rows: usize,
    stride: usize,
    out: &mut [f32],
    out_stride: usize,
) {
    let n = layer.bias.len();
    for row in 0..rows {
        out[row * out_stride..][..n].copy_from_slice(&layer.bias);
    }
    product::<S>(&layer.weight, n, x, stride, rows, out, out_stride);
}

/// `out_r += h_r U` for `count` rows side by side, U of `state` × 4 `state`.
#[inline(always)]
pub fn add_product<S: Sum>(weight: &[f32], hidden: &[f32], count: usize, state: usize, out: &mut [f32]) {
    product::<S>(weight, 4 * state, hidden, state, count, out, 4 * state);
}

/// `out += x W`, block by block.
#[inline(always)]
fn product<S: Sum>(
    weight: &[f32],
    n: usize,
    x: &[f32],
    stride: usize,
    rows: usize,
    out: &mut [f32],
    out_stride: usize,
) {
    if n == 0 {
        return;
    }
    let k = weight.len() / n;
    let mut row = 0;
    while row + ROWS <= rows {
        let xs: [&[f32]; ROWS] = std::array::from_fn(|r| &x[(row + r) * stride..][..k]);
        rows_by_columns::<S, _>(weight, n, &xs, &mut out[row * out_stride..], out_stride);
        row += ROWS;
    }
    for row in row..rows {
        rows_by_columns::<S, _>(
            weight,
            n,
            &[&x[row * stride..][..k]],
            &mut out[row * out_stride..],
            out_stride,
        );
    }
}

#[inline(always)]
fn rows_by_columns<S: Sum, const R: usize>(
    weight: &[f32],
    n: usize,
    xs: &[&[f32]; R],
    out: &mut [f32],
    out_stride: usize,
) {
    let mut column = 0;
    while column + LANES <= n {
        block::<S, R, LANES>(weight, n, column, xs, out, out_stride);
        column += LANES;
    }
    if column + HALF <= n {
        block::<S, R, HALF>(weight, n, column, xs, out, out_stride);
        column += HALF;
    }
    for column in column..n {
        for (r, x) in xs.iter().enumerate() {
            let sum =
                x.iter().zip(weight[column..].iter().step_by(n)).fold(0.0, |sum, (x, w)| S::add(sum, *x, *w));
            out[r * out_stride + column] += sum;
        }
    }
}

/// `L` outputs of `R` rows from `column` on.
#[inline(always)]
fn block<S: Sum, const R: usize, const L: usize>(
    weight: &[f32],
    n: usize,
    column: usize,
    xs: &[&[f32]; R],
    out: &mut [f32],
    out_stride: usize,
) {
    let mut sums = [[0.0_f32; L]; R];
    for (r, sums) in sums.iter_mut().enumerate() {
        sums.copy_from_slice(&out[r * out_stride + column..][..L]);
    }
    for i in 0..xs[0].len() {
        let (weights, _) = weight[i * n + column..].as_chunks::<L>();
        let weights = &weights[0];
        for (sums, x) in sums.iter_mut().zip(xs) {
            let x = x[i];
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum = S::add(*sum, x, *weight);
            }
        }
    }
    for (r, sums) in sums.iter().enumerate() {
        out[r * out_stride + column..][..L].copy_from_slice(sums);
    }
}

/// What is below 0 becomes 0.
#[inline(always)]
pub fn relu(values: &mut [f32]) {
    for value in values {
        *value = value.max(0.0);
    }
}

/// One step of an LSTM from the four gates before their functions.
#[inline(always)]
pub fn lstm<S: Sum>(gates: &mut [f32], cell: &mut [f32], hidden: &mut [f32]) {
    let state = cell.len();
    let (input, rest) = gates.split_at_mut(state);
    let (forget, rest) = rest.split_at_mut(state);
    let (candidate, output) = rest.split_at_mut(state);
    for (i, f) in input.iter_mut().zip(&mut *forget) {
        *i = sigmoid::<S>(*i);
        *f = sigmoid::<S>(*f);
    }
    for (g, o) in candidate.iter_mut().zip(&mut *output) {
        *g = tanh::<S>(*g);
        *o = sigmoid::<S>(*o);
    }
    for ((c, f), (i, g)) in cell.iter_mut().zip(&*forget).zip(input.iter().zip(&*candidate)) {
        *c = S::add(f * *c, *i, *g);
    }
    for ((h, c), o) in hidden.iter_mut().zip(&*cell).zip(&*output) {
        *h = o * tanh::<S>(*c);
    }
}

/// `1 / (1 + e^−x)`.
#[inline(always)]
pub fn sigmoid<S: Sum>(x: f32) -> f32 {
    1.0 / (1.0 + exp::<S>(-x))
}

/// `1 − 2 / (1 + e^2x)`.
#[inline(always)]
pub fn tanh<S: Sum>(x: f32) -> f32 {
    1.0 - 2.0 / (1.0 + exp::<S>(2.0 * x))
}

/// `e^x` to 2e-7 of itself for |x| ≤ 80; beyond, as at ±80. `2^n · e^r` with `n` the nearest whole number to `x / ln 2` and Taylor's series of `e^r` up to `r⁷`, |r| ≤ 0.35.
#[inline(always)]
pub fn exp<S: Sum>(x: f32) -> f32 {
    /// Added to a number it leaves its whole part in the last bits.
    const ROUNDER: f32 = 12_582_912.0;
    // ln 2 in two parts, the first with few bits so that n times it is exact (Cody & Waite 1980).
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    let x = x.clamp(-80.0, 80.0);
    let shifted = S::add(ROUNDER, x, std::f32::consts::LOG2_E);
    let n = shifted - ROUNDER;
    let r = S::add(S::add(x, n, -LN2_HIGH), n, -LN2_LOW);
    let series = 1.0 / 5040.0;
    let series = S::add(1.0 / 720.0, series, r);
    let series = S::add(1.0 / 120.0, series, r);
    let series = S::add(1.0 / 24.0, series, r);
    let series = S::add(1.0 / 6.0, series, r);
    let series = S::add(0.5, series, r);
    let series = S::add(1.0, S::add(1.0, series, r), r);
    series * f32::from_bits((shifted.to_bits() << 23).wrapping_add(127 << 23))
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "tests: these are exact")]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_right_to_its_last_bits() {
        let worst = (-8000..=8000_i16).map(|k| f32::from(k) / 100.0).fold(0.0_f64, |worst, x| {
            let exact = f64::from(x).exp();
            worst.max((f64::from(exp::<Apart>(x)) / exact - 1.0).abs())
        });
        assert!(worst < 2e-7, "{worst:e}");
        let apart = (-800..=800_i16)
            .map(|k| f32::from(k) / 10.0)
            .map(|x| (exp::<Fused>(x) / exp::<Apart>(x) - 1.0).abs());
        assert!(apart.fold(0.0, f32::max) < 2e-7);
    }

    #[test]
    fn gates_are_the_functions_of_the_standard_library_within_rounding() {
        for x in (-3000..=3000_i16).map(|k| f32::from(k) / 100.0) {
            assert!((tanh::<Fused>(x) - x.tanh()).abs() < 3e-7, "{x}");
            assert!((tanh::<Apart>(x) - x.tanh()).abs() < 3e-7, "{x}");
            assert!((sigmoid::<Apart>(x) - 1.0 / (1.0 + (-x).exp())).abs() < 2e-7, "{x}");
        }
        assert!(tanh::<Apart>(f32::INFINITY) == 1.0 && sigmoid::<Apart>(f32::NEG_INFINITY) < 1e-30);
    }

    /// Every shape of blocks and remainders against the definition in double precision.
    #[test]
    fn products_are_sums_of_products() {
        for (inputs, outputs, rows, stride) in
            [(10, 16, 38, 4), (7, 35, 5, 7), (3, 3, 1, 0), (24, 128, 9, 24)]
        {
            let value = |k: usize| ((k * 37 % 101) as f32 - 50.0) / 50.0;
            let layer = Layer {
                weight: (0..inputs * outputs).map(value).collect(),
                bias: (0..outputs).map(|k| value(k + 5)).collect(),
            };
            let x: Vec<f32> = (0..(rows - 1) * stride + inputs).map(|k| value(k + 11)).collect();
            let out_stride = outputs + 3;
            let mut out = vec![9.0; rows * out_stride];
            affine::<Apart>(&layer, &x, rows, stride, &mut out, out_stride);
            for row in 0..rows {
                for column in 0..outputs {
                    let sum: f64 = (0..inputs)
                        .map(|i| {
                            f64::from(x[row * stride + i]) * f64::from(layer.weight[i * outputs + column])
                        })
                        .sum();
                    let expected = sum + f64::from(layer.bias[column]);
                    // 24 products of at most 1.
                    assert!((f64::from(out[row * out_stride + column]) - expected).abs() < 1e-5);
                }
                assert!(out[row * out_stride + outputs..(row + 1) * out_stride].iter().all(|v| *v == 9.0));
            }
        }
    }
}
