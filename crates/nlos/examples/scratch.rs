//! scratch
#![allow(missing_docs, clippy::all, clippy::pedantic, clippy::unwrap_used)]
use adit_nlos::{examples::Examples, folds, judging::*, baseline::*, training, network::Scratch};
use rayon::prelude::*;
fn main() {
    let sets: Vec<_> = std::env::args().skip(1).map(|p| adit_observation::csv_log::labelled::read(p).unwrap()).collect();
    let examples = Examples::of(&sets);
    let judged = sets[0].ranges.len(); let rows: Vec<usize> = (0..judged).collect(); let also: Vec<usize> = (judged..examples.rows.len()).collect();
    let folds = folds::by_group(&examples, &rows, std::env::var("FOLDS").ok().and_then(|v| v.parse().ok()).unwrap_or(8), 1).unwrap();
    let resp = examples.rows[0].window.is_some();
    let settings = training::Settings::of(resp);
    let seeds: u64 = std::env::var("SEEDS").ok().and_then(|v| v.parse().ok()).unwrap_or(1);
    let t0 = std::time::Instant::now();
    // per epoch: logits per row
    let mut sum: Vec<HeldOut> = vec![];
    for seed in 0..seeds {
    let per: Vec<Vec<(Vec<usize>, Vec<adit_nlos::calibration::Logits>)>> = folds.par_iter().enumerate().map(|(f, held)| {
        let learn: Vec<usize> = rows.iter().copied().filter(|r| !held.contains(&examples.rows[*r].group)).collect();
        let learn: Vec<usize> = learn.into_iter().chain(also.iter().copied()).collect(); let ask: Vec<usize> = rows.iter().copied().filter(|r| held.contains(&examples.rows[*r].group)).collect();
        let b = Baseline::learn(&examples, &learn, 0.2).unwrap();
        let mut out = vec![];
        let mut s = Scratch::default();
        training::train(&examples, &learn, &b, &settings, 100 * seed + f as u64, |_, n| {
            let c = examples.classes.len() - 1;
            let l: Vec<[f32;2]> = ask.iter().map(|r| { let mut o = [0.0; 2]; n.logits(&b.scores(&examples.rows[*r].features), examples.rows[*r].window.as_deref(), &mut s, &mut o[..c]); o }).collect();
            out.push((ask.clone(), l));
        }).unwrap();
        out
    }).collect();
    for e in 0..settings.epochs as usize {
        let h = HeldOut { rows: per.iter().flat_map(|p| p[e].0.clone()).collect(), logits: per.iter().flat_map(|p| p[e].1.clone()).collect() };
        if seed == 0 { sum.push(h.clone()); } else { for (a, b) in sum[e].logits.iter_mut().zip(&h.logits) { for (a, b) in a.iter_mut().zip(b) { *a += b; } } }
        let t = h.scalings(&examples); let m = h.measures(&examples);
        if e + 1 == settings.epochs as usize || seeds == 1 { println!("s{seed} e{} T {:.2} {:.2} acc {:.3} mf1 {:.3} | {:.3} {:.3} {:.3} ece {:.3} loss {:.3} {:.0?}", e + 1, t[0].scale, t[0].offset, m.accuracy, m.macro_f1, m.binary.accuracy, m.binary.balanced_accuracy, m.binary.f1, m.binary.calibration_error, m.log_loss, t0.elapsed()); }
    }
    }
    if seeds > 1 { for (e, h) in sum.iter().enumerate().filter(|(e,_)| e % 3 == 2) { let t = h.scalings(&examples); let m = h.measures(&examples);
       println!("mean e{} T {:.2} {:.2} acc {:.3} mf1 {:.3} | {:.3} {:.3} {:.3} ece {:.3} loss {:.3}", e + 1, t[0].scale, t[0].offset, m.accuracy, m.macro_f1, m.binary.accuracy, m.binary.balanced_accuracy, m.binary.f1, m.binary.calibration_error, m.log_loss); } }
}
